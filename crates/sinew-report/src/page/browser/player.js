// The page at work: time, controls and keys, and what follows them.

const FIRST_PLOTS = 4;

/** What the controls of the page and the views share. */
function newState(data, scene) {
  const moved = Math.max(scene.size.high[0] - scene.size.low[0], scene.size.high[1] - scene.size.low[1]);
  return { frame: 0, playing: false, clock: 0, eye: newEye(), follow: moved > 2.5, wide: false, dirty: true, colours: theme() };
}

function resetEye(state, data, scene, stage) {
  const { eye } = state;
  const all = [scene.size.low, scene.size.high, ...(state.wide ? scene.cameras.map((camera) => camera.centre) : [])];
  const low = [0, 1, 2].map((k) => Math.min(...all.map((place) => place[k])));
  const high = [0, 1, 2].map((k) => Math.max(...all.map((place) => place[k])));
  eye.target = times(add(low, high), 0.5);
  let radius = 0.5 * Math.hypot(...minus(high, low));
  if (state.follow && !state.wide) {
    radius = Math.min(radius, 1.15);
    eye.target = middleOf(data, state.frame);
  }
  eye.distance = distanceTo(radius, stage.clientWidth, stage.clientHeight);
  Object.assign(eye, facing(data));
  state.dirty = true;
}

/** A direction from which the person is seen from the front and a little aside. */
function facing(data) {
  const find = (name) => data.points.find((point) => point.name === name);
  const [left, right] = [find("LHip") || find("LShoulder"), find("RHip") || find("RShoulder")];
  if (!left || !right) return { yaw: 0.6, pitch: 0.25 };
  const across = minus(placeOf(right, 0), placeOf(left, 0));
  const forward = cross([0, 0, 1], across);
  return { yaw: Math.atan2(forward[1], forward[0]) + 0.6, pitch: 0.2 };
}

/** The strip of frames by how many cameras saw the person; not shown where two did all the time. */
function drawStrip(canvas, data, colours) {
  const odd = data.quality.some((quality) => quality < 2) || data.restarted.some((flag, index) => flag > 0 && index > 0);
  canvas.hidden = !odd;
  document.getElementById("strip-key").hidden = !odd;
  if (!odd) return;
  canvas.width = Math.max(1, canvas.clientWidth);
  const context = canvas.getContext("2d");
  const width = canvas.width / data.frames;
  data.quality.forEach((quality, index) => {
    context.fillStyle = quality < 1 ? colours.bad : quality < 2 ? colours.one : colours.grid;
    if (data.restarted[index] > 0 && index > 0) context.fillStyle = colours.text;
    context.fillRect(index * width, 0, Math.max(1, width), canvas.height);
  });
}

function main(data, vendor) {
  const element = (id) => document.getElementById(id);
  const stage = element("stage");
  const scene = sceneOf(data);
  const state = newState(data, scene);
  let solid = null;
  let flat = null;
  const useViews = (found) => {
    solid = found;
    flat = canvasView(element("flat"), data, scene, !solid);
    element("solid").hidden = !solid;
    document.documentElement.dataset.view = solid ? "webgl" : "canvas";
    state.dirty = true;
  };
  let webgl = webglView(element("solid"), data, scene, vendor);
  useViews(webgl);
  element("solid").addEventListener("webglcontextlost", () => {
    webgl = null;
    useViews(null);
  });
  // Printers see the flat canvas.
  window.addEventListener("beforeprint", () => useViews(null));
  window.addEventListener("afterprint", () => useViews(webgl));
  const plots = [];

  const clock = (frame) => `frame ${data.number[frame]} · ${data.time[frame].toFixed(2)} s`;
  const goTo = (frame) => {
    const next = Math.min(data.frames - 1, Math.max(0, Math.round(frame)));
    if (next === state.frame) return;
    state.frame = next;
    state.dirty = true;
  };
  const setPlaying = (playing) => {
    state.playing = playing && data.frames > 1;
    if (state.playing && state.frame === data.frames - 1) goTo(0);
    state.clock = data.time[state.frame];
    const button = element("play");
    button.setAttribute("aria-label", state.playing ? "Pause" : "Play");
    document.documentElement.dataset.playing = state.playing;
  };
  const seek = (frame, firm) => {
    if (state.playing && !firm) return;
    if (firm) setPlaying(false);
    goTo(frame);
  };
  const addPlots = (place, groups) => groups.map((group) => {
    const plot = plotIn(place, vendor.uPlot, data, group, seek);
    plots.push(plot);
    plot.show(state.frame);
    return plot;
  });

  const draw = () => {
    state.dirty = false;
    if (state.follow && !state.wide) state.eye.target = middleOf(data, state.frame);
    const ellipsoids = Number(element("ellipsoids").value);
    solid?.(state.eye, state.frame, ellipsoids, state.colours);
    flat(state.eye, state.frame, ellipsoids, state.colours);
    element("scrub").value = state.frame;
    element("scrub").setAttribute("aria-valuetext", clock(state.frame));
    element("clock").textContent = clock(state.frame);
    plots.forEach((plot) => plot.show(state.frame));
  };
  let before = performance.now();
  const tick = (now) => {
    const elapsed = Math.min(0.25, (now - before) / 1000);
    before = now;
    if (state.playing) {
      state.clock += elapsed * Number(element("speed").value);
      if (state.clock > data.time[data.frames - 1] + 0.5 / data.fps) state.clock = data.time[0];
      goTo(frameAt(data, state.clock));
    }
    if (state.dirty) draw();
    requestAnimationFrame(tick);
  };

  element("scrub").max = data.frames - 1;
  element("follow").checked = state.follow;
  element("ellipsoids").value = areSmall(data) ? 3 : 1;
  element("play").addEventListener("click", () => setPlaying(!state.playing));
  element("scrub").addEventListener("input", (event) => seek(Number(event.target.value), true));
  element("home").addEventListener("click", () => resetEye(state, data, scene, stage));
  element("ellipsoids").addEventListener("change", () => { state.dirty = true; });
  for (const name of ["follow", "wide"]) {
    element(name).addEventListener("change", (event) => {
      state[name] = event.target.checked;
      resetEye(state, data, scene, stage);
    });
  }
  listenToKeys({ toggle: () => setPlaying(!state.playing), step: (by) => seek(state.frame + by, true), end: (last) => seek(last ? data.frames - 1 : 0, true) });
  steer(stage, state.eye, () => { state.dirty = true; });
  resetEye(state, data, scene, stage);
  fillPlots(data, addPlots, plots, element);
  followPage(state, data, plots, element, draw);
  draw();
  requestAnimationFrame(tick);
  setPlaying(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  document.documentElement.dataset.state = "ready";
}

/** The last frame that is not later than a time. */
function frameAt(data, time) {
  let [low, high] = [0, data.frames - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (data.time[middle] <= time + 1e-6) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Space, arrows, Home and End, wherever no control uses them itself. */
function listenToKeys({ toggle, step, end }) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    const kind = event.target instanceof HTMLElement ? event.target.tagName : "";
    if (["SELECT", "BUTTON", "SUMMARY", "A"].includes(kind) || (kind === "INPUT" && event.target.type !== "range")) return;
    const ranged = kind === "INPUT";
    if (event.key === " ") toggle();
    else if (event.key === "ArrowLeft" && !ranged) step(-1);
    else if (event.key === "ArrowRight" && !ranged) step(1);
    else if (event.key === "Home" && !ranged) end(false);
    else if (event.key === "End" && !ranged) end(true);
    else return;
    event.preventDefault();
  });
}

/** Curves: first ones beside the player, the others when they are wanted. */
function fillPlots(data, addPlots, plots, element) {
  const groups = angleGroups(data);
  addPlots(element("first"), groups.slice(0, FIRST_PLOTS));
  const rest = element("rest");
  const details = rest.closest("details");
  const fill = () => { if (details.open && !rest.childElementCount) addPlots(rest, groups.slice(FIRST_PLOTS)); };
  details.addEventListener("toggle", fill);
  const choice = element("point");
  data.points.forEach((point, index) => choice.append(new Option(point.name, index)));
  const wrist = data.points.findIndex((point) => point.name === "RWrist");
  choice.value = Math.max(0, wrist);
  let shown = [];
  const choose = () => {
    shown.forEach((plot) => { plots.splice(plots.indexOf(plot), 1); plot.figure.remove(); });
    shown = addPlots(element("axes"), pointCurves(data.points[Number(choice.value)]));
  };
  choice.addEventListener("change", choose);
  choose();
  if (data.residuals.some((column) => column.some(Number.isFinite))) addPlots(element("residuals"), [{ title: "residual", curves: residualCurves(data) }]);
  window.addEventListener("beforeprint", () => { details.open = true; fill(); });
}

/** What follows the window: its size, its colours, its printer. */
function followPage(state, data, plots, element, draw) {
  const repaint = () => {
    state.colours = theme();
    plots.forEach((plot) => plot.repaint());
    drawStrip(element("strip"), data, state.colours);
    draw();
  };
  new ResizeObserver(() => { state.dirty = true; }).observe(element("stage"));
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  window.matchMedia("print").addEventListener("change", repaint);
  window.addEventListener("beforeprint", () => document.querySelectorAll("details:not(.licences)").forEach((details) => { details.open = true; }));
  drawStrip(element("strip"), data, state.colours);
}

/** The libraries, if the browser can run them. */
async function vendorOf() {
  const script = document.createElement("script");
  script.textContent = `${new TextDecoder().decode(await unpacked("vendor"))}\nwindow.sinewVendor = sinewVendor;`;
  document.head.append(script);
  return window.sinewVendor;
}

(async () => {
  const problem = document.getElementById("problem");
  const report = (words) => {
    problem.textContent = words;
    problem.hidden = false;
    document.documentElement.dataset.state = "failed";
  };
  if (typeof DecompressionStream === "undefined") {
    report("This browser is too old for the player and the curves (it lacks DecompressionStream). Firefox 113, Chrome 80, Safari 16.4 and newer have it. Words and tables below are whole.");
    return;
  }
  try {
    main(readPayload(await unpacked("payload")), await vendorOf());
  } catch (error) {
    report(`The player and the curves failed (${error.message}). Words and tables below are whole.`);
    throw error;
  }
})();
