// What is to be drawn, without saying how: places of points, floor, cameras.

const ELLIPSOID_90 = Math.sqrt(6.251); // 90 % of a Gaussian in three dimensions lie within that many standard deviations.
const FRUSTUM_M = 0.35;
const GRID_M = 0.5;

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => times(a, 1 / (Math.hypot(...a) || 1));

/** Place of a point in a frame. */
const placeOf = (point, frame) => point.axes.map((axis) => axis.mean[frame]);

/** Middle of the points of a frame. */
function middleOf(data, frame) {
  const sum = data.points.reduce((all, point) => add(all, placeOf(point, frame)), [0, 0, 0]);
  return times(sum, 1 / Math.max(1, data.points.length));
}

/** Least and greatest coordinates of all points over all frames. */
function extent(data) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const point of data.points) {
    point.axes.forEach((axis, k) => {
      for (const value of axis.mean) {
        if (value < low[k]) low[k] = value;
        if (value > high[k]) high[k] = value;
      }
    });
  }
  return { low, high };
}

/** Lines of a floor under all that moves. */
function floorLines({ low, high }) {
  const first = [0, 1].map((k) => Math.floor(low[k] / GRID_M - 1) * GRID_M);
  const last = [0, 1].map((k) => Math.ceil(high[k] / GRID_M + 1) * GRID_M);
  const z = low[2];
  const step = GRID_M * Math.max(1, Math.ceil((last[0] - first[0] + last[1] - first[1]) / GRID_M / 80));
  const lines = [];
  for (let x = first[0]; x <= last[0] + 1e-9; x += step) lines.push([[x, first[1], z], [x, last[1], z]]);
  for (let y = first[1]; y <= last[1] + 1e-9; y += step) lines.push([[first[0], y, z], [last[0], y, z]]);
  return lines;
}

/** Cameras that stand somewhere, as lines of a pyramid; one of unknown direction looks at the middle. */
function cameraShapes(cameras, middle) {
  return cameras.filter((camera) => camera.centre.every(Number.isFinite)).map((camera) => {
    let axes = camera.axes;
    if (!axes) {
      const forward = unit(minus(middle, camera.centre));
      const right = unit(cross(forward, [0, 0, 1]));
      axes = [right, cross(forward, right), forward];
    }
    const half = camera.half || [0.55, 0.4];
    const corner = ([u, v]) => add(camera.centre, times(add(axes[2], add(times(axes[0], u * half[0]), times(axes[1], v * half[1]))), FRUSTUM_M));
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(corner);
    const lines = corners.flatMap((from, k) => [[from, corners[(k + 1) % 4]], [camera.centre, from]]);
    return { name: camera.name, centre: camera.centre, lines };
  });
}

/** Side of a line between two points: that of both, else the middle. */
const boneSide = (data, [from, to]) => {
  const [a, b] = [data.points[from].side, data.points[to].side];
  return a === b ? a : a === "middle" ? b : b === "middle" ? a : "middle";
};

/** Whether ellipsoids are better seen when they are drawn larger: half of them reach less than 8 cm. */
function areSmall(data) {
  const reach = data.points.map((point) => {
    const middle = data.frames >> 1;
    return ELLIPSOID_90 * Math.hypot(...point.factor.map((numbers) => numbers[middle]));
  });
  return reach.filter((metres) => metres > 0.08).length <= 0.5 * reach.length;
}

/** All that does not change from frame to frame. */
function sceneOf(data) {
  const size = extent(data);
  const middle = times(add(size.low, size.high), 0.5);
  return { size, middle, floor: floorLines(size), cameras: cameraShapes(data.cameras, middle), sides: data.bones.map((bone) => boneSide(data, bone)) };
}

/** Colours of the page as the style has them now. */
function theme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  return Object.fromEntries(["left", "right", "middle", "text", "quiet", "grid", "view", "line", "accent", "bad", "one"].map((name) => [name, colour(name)]));
}
