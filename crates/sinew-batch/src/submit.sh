#!/bin/sh
# Runs a study as an array of jobs: sbatch submit.sh
# A job that is stopped in between (time limit, preemption) keeps what is done and is queued again.
#SBATCH --job-name=sinew
#SBATCH --array=0-{LAST}
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --signal=B:TERM@60
#SBATCH --output=sinew-%a.out
#SBATCH --open-mode=append
study={STUDY}
sinew batch run "$study" --shard "$SLURM_ARRAY_TASK_ID/{SHARDS}" --no-progress &
child=$!
trap 'kill -TERM "$child"' TERM
wait "$child"
code=$?
if kill -0 "$child" 2>/dev/null; then
    wait "$child"
    code=$?
fi
# 75: interrupted; what was not done is begun again.
if [ "$code" = 75 ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}"
fi
exit "$code"
