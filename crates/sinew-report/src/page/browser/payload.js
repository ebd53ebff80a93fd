"use strict";
// The numbers of the page: text in base64, deflated; columns of whole steps, coded as differences (columns.rs, payload.rs).

/** Bytes of a packed element of the page. */
async function unpacked(id) {
  const text = document.getElementById(id).textContent;
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** A reader of one column after the other. */
function columnReader(bytes, start, count) {
  let at = start;
  return (step) => {
    const values = new Float64Array(count);
    let before = 0;
    for (let index = 0; index < count; index++) {
      let value = 0;
      let factor = 1;
      let byte;
      do {
        byte = bytes[at++];
        value += (byte & 127) * factor;
        factor *= 128;
      } while (byte > 127);
      if (value === 0) {
        values[index] = NaN;
        continue;
      }
      const folded = value - 1;
      before += folded % 2 === 0 ? folded / 2 : -(folded + 1) / 2;
      values[index] = before * step;
    }
    return values;
  };
}

/** Left, right or middle, by the name of a point. */
function sideOf(name) {
  const found = /^([LR])[A-Z]/.exec(name) || /^(l|r)(eft|ight)?_/.exec(name);
  return found ? (found[1].toLowerCase() === "l" ? "left" : "right") : "middle";
}

/** Head and columns as one object. */
function readPayload(bytes) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  const next = columnReader(bytes, 4 + length, head.frames);
  const steps = head.steps;
  const band = (step) => {
    const [mean, below, above] = [next(step), next(step), next(step)];
    return { mean, low: mean.map((value, index) => value - below[index]), high: mean.map((value, index) => value + above[index]) };
  };
  const data = { ...head, number: next(1), quality: next(1), restarted: next(1), rhat: next(steps.rhat) };
  data.residuals = head.cameras.map(() => next(steps.residual));
  data.points = head.points.map((name) => {
    const axes = [0, 1, 2].map(() => band(steps.position));
    const factor = [0, 1, 2, 3, 4, 5].map(() => next(steps.position));
    return { name, side: sideOf(name), axes, factor };
  });
  data.angles = head.angles.map((angle) => ({ ...angle, band: band(steps.angle), seen: next(1) }));
  data.time = data.number.map((number) => number / head.fps);
  return data;
}
