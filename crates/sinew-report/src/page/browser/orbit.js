// The eye of the player: it turns about a place that it looks at.

const FIELD = (40 * Math.PI) / 180;
const STEEPEST = 1.5;

/** An eye at rest. */
function newEye() {
  return { yaw: 0, pitch: 0, distance: 4, target: [0, 0, 1] };
}

/** Place and axes (right, up, forward) of an eye. */
function eyeFrame(eye) {
  const [c, s] = [Math.cos(eye.pitch), Math.sin(eye.pitch)];
  const back = [c * Math.cos(eye.yaw), c * Math.sin(eye.yaw), s];
  const forward = times(back, -1);
  const right = unit(cross(forward, [0, 0, 1]));
  return { place: add(eye.target, times(back, eye.distance)), right, up: cross(right, forward), forward };
}

/** A map from the world to pixels and depth; nothing for what is behind the eye. */
function projector(eye, width, height) {
  const { place, right, up, forward } = eyeFrame(eye);
  const focal = (0.5 * height) / Math.tan(0.5 * FIELD);
  const project = (point) => {
    const from = minus(point, place);
    const depth = dot(from, forward);
    if (depth < 0.05) return null;
    return [0.5 * width + (focal * dot(from, right)) / depth, 0.5 * height - (focal * dot(from, up)) / depth, depth];
  };
  return { project, right, up, forward, focal };
}

/** Distance from which a ball of that radius fills the view. */
function distanceTo(radius, width, height) {
  const narrow = Math.min(1, width / Math.max(1, height));
  return radius / Math.sin(0.5 * FIELD) / Math.max(0.3, narrow);
}

/** Turns and zooms an eye by pointers, wheel and keys; `changed` is called after each. */
function steer(stage, eye, changed) {
  const pointers = new Map();
  const turn = (dx, dy) => {
    eye.yaw -= dx * 0.008;
    eye.pitch = Math.min(STEEPEST, Math.max(-0.2, eye.pitch + dy * 0.008));
    changed();
  };
  const zoom = (factor) => {
    eye.distance = Math.min(200, Math.max(0.3, eye.distance * factor));
    changed();
  };
  const apart = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  stage.addEventListener("pointerdown", (event) => {
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const span = pointers.size === 2 ? apart() : 0;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 2) zoom(span / Math.max(1, apart()));
    else turn(event.clientX - before[0], event.clientY - before[1]);
  });
  for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, (event) => pointers.delete(event.pointerId));
  // A wheel scrolls the page unless the player has the focus.
  stage.addEventListener("wheel", (event) => {
    if (document.activeElement !== stage && !event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(event.deltaY * 0.001));
  }, { passive: false });
  const keys = { ArrowLeft: [-25, 0], ArrowRight: [25, 0], ArrowUp: [0, 25], ArrowDown: [0, -25] };
  stage.addEventListener("keydown", (event) => {
    if (event.shiftKey && keys[event.key]) turn(...keys[event.key]);
    else if (event.key === "+" || event.key === "=") zoom(0.85);
    else if (event.key === "-") zoom(1 / 0.85);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}
