// The player on a flat canvas: everything where there is no WebGL, else the names of the cameras alone.

/** A canvas as large as its place, in its own pixels. */
function fitted(canvas) {
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/** Semi-axes and direction of the ellipse that an ellipsoid L shows. */
function shownEllipse(view, [x, y, depth], factor, scale) {
  const [a, b, d, c, e, f] = factor;
  const columns = [[a, b, c], [0, d, e], [0, 0, f]];
  const k = (scale * view.focal) / depth;
  const rows = [columns.map((column) => k * dot(column, view.right)), columns.map((column) => -k * dot(column, view.up))];
  const [uu, uv, vv] = [dot(rows[0], rows[0]), dot(rows[0], rows[1]), dot(rows[1], rows[1])];
  const mean = 0.5 * (uu + vv);
  const half = Math.hypot(0.5 * (uu - vv), uv);
  return { x, y, long: Math.sqrt(mean + half), short: Math.sqrt(Math.max(0, mean - half)), turn: 0.5 * Math.atan2(2 * uv, uu - vv) };
}

function strokeLine(context, project, [from, to]) {
  const [a, b] = [project(from), project(to)];
  if (!a || !b) return;
  context.beginPath();
  context.moveTo(a[0], a[1]);
  context.lineTo(b[0], b[1]);
  context.stroke();
}

function cameraNames(context, view, scene, colours) {
  context.fillStyle = colours.quiet;
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  for (const camera of scene.cameras) {
    const at = view.project(camera.centre);
    if (at) context.fillText(camera.name.slice(0, 40), at[0], at[1] - 8);
  }
}

function flatScene(context, view, scene, colours) {
  context.lineCap = "round";
  context.lineWidth = 1;
  context.strokeStyle = colours.grid;
  scene.floor.forEach((line) => strokeLine(context, view.project, line));
  context.strokeStyle = colours.quiet;
  scene.cameras.forEach((camera) => camera.lines.forEach((line) => strokeLine(context, view.project, line)));
}

function flatFigure(context, view, data, scene, frame, ellipsoids, colours) {
  const shown = data.points.map((point) => view.project(placeOf(point, frame)));
  const pixels = (at, metres) => (metres * view.focal) / at[2];
  const parts = [];
  data.bones.forEach(([from, to], index) => {
    const [a, b] = [shown[from], shown[to]];
    if (!a || !b) return;
    parts.push({ depth: 0.5 * (a[2] + b[2]), draw() {
      context.strokeStyle = colours[scene.sides[index]];
      context.lineWidth = Math.max(1.5, pixels(a, 0.032));
      context.beginPath();
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
      context.stroke();
    } });
  });
  data.points.forEach((point, index) => {
    const at = shown[index];
    if (!at) return;
    parts.push({ depth: at[2] - 0.01, draw() {
      context.fillStyle = colours[point.side];
      context.beginPath();
      context.arc(at[0], at[1], Math.max(2, pixels(at, 0.024)), 0, 2 * Math.PI);
      context.fill();
    } });
    if (ellipsoids > 0) parts.push({ depth: at[2] - 0.05, draw() {
      const ellipse = shownEllipse(view, at, point.factor.map((numbers) => numbers[frame]), ellipsoids * ELLIPSOID_90);
      context.globalAlpha = 0.28;
      context.fillStyle = colours[point.side];
      context.beginPath();
      context.ellipse(ellipse.x, ellipse.y, ellipse.long, ellipse.short, ellipse.turn, 0, 2 * Math.PI);
      context.fill();
      context.globalAlpha = 1;
    } });
  });
  parts.sort((a, b) => b.depth - a.depth).forEach((part) => part.draw());
}

/** A view that draws a frame on the flat canvas; `whole` where nothing else does. */
function canvasView(canvas, data, scene, whole) {
  return (eye, frame, ellipsoids, colours) => {
    const { context, width, height } = fitted(canvas);
    if (width === 0 || height === 0) return;
    const view = projector(eye, width, height);
    if (whole) {
      flatScene(context, view, scene, colours);
      flatFigure(context, view, data, scene, frame, ellipsoids, colours);
    }
    cameraNames(context, view, scene, colours);
  };
}
