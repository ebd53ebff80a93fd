#!/bin/sh
# Runs a study with GNU parallel, here or on other machines (parallel --sshlogin): sh parallel.sh
seq 0 {LAST} | parallel --quote --line-buffer sinew batch run {STUDY} --shard {}/{SHARDS} --threads 1
sinew batch gather {STUDY}
