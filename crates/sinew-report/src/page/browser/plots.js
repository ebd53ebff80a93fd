// Curves over time with their bands, each with a line at the frame of the player.

const CAMERA_COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a8f98", "#b8a900"];
const PLOT_HEIGHT = 118;

/** `#rrggbb` with an opacity. */
const faint = (colour, opacity) => colour + Math.round(255 * opacity).toString(16).padStart(2, "0");

/** Numbers as uPlot takes them: null is a gap. */
const gaps = (values) => Array.from(values, (value) => (Number.isFinite(value) ? value : null));

/** Share of the frames in which keypoints do not show an angle. */
const unseenShare = (seen) => (seen ? seen.reduce((sum, flag) => sum + (flag === 0 ? 1 : 0), 0) / seen.length : 0);

/** A column where `keep` holds, else gaps. */
const where = (values, keep) => Array.from(values, (value, index) => (Number.isFinite(value) && keep(index) ? value : null));

/** Multiples of a step in a range, in finer steps where there are fewer than two. */
function ticksIn(low, high, step) {
  let found = [];
  const mantissa = step / 10 ** Math.floor(Math.log10(step) + 1e-9);
  for (const part of Math.abs(mantissa - 2.5) < 1e-6 ? [1, 2.5, 5] : [1, 2, 5, 10]) {
    const fine = step / part;
    found = [];
    for (let k = Math.ceil(low / fine - 1e-9); k * fine <= high + 1e-9 * fine; k++) found.push(+(k * fine).toPrecision(12));
    if (found.length > 1) break;
  }
  return found;
}

/** Mean, low and high of a curve: where keypoints show it, and where they do not, with a frame beside so that the line is whole. */
function partsOf({ band, values, seen }) {
  const columns = band ? [band.mean, band.low, band.high] : [values];
  if (unseenShare(seen) === 0) return [{ columns: columns.map(gaps), shown: true }];
  const isShown = (index) => seen[index] !== 0;
  const isDashed = (index) => [index - 1, index, index + 1].some((near) => seen[near] === 0);
  return [{ columns: columns.map((column) => where(column, isShown)), shown: true }, { columns: columns.map((column) => where(column, isDashed)), shown: false }];
}

/**
 * A plot in `place`. `names` are words for the curious, `curves` are `{ name, colour(), band | values, seen, unit, digits }`; `seek(frame, firm)` moves the player.
 * Returns `{ show(frame), repaint() }`.
 */
function plotIn(place, uPlot, data, { title, names, curves }, seek) {
  const figure = document.createElement("figure");
  figure.className = "plot";
  const caption = document.createElement("figcaption");
  const name = document.createElement("b");
  name.textContent = title;
  const small = document.createElement("span");
  small.className = "names";
  small.textContent = names || "";
  const now = document.createElement("span");
  now.className = "now";
  const keys = curves.map(() => {
    const [key, swatch, words] = ["span", "i", "span"].map((tag) => document.createElement(tag));
    if (curves.length > 1) key.append(swatch);
    key.append(words);
    now.append(key);
    return { swatch, words };
  });
  caption.append(name, small, now);
  figure.append(caption);
  place.append(figure);
  const line = document.createElement("div");
  line.className = "head";
  let chart = null;
  let frame = 0;

  if (curves.some(({ seen }) => unseenShare(seen) > 0)) {
    const key = document.createElement("span");
    key.className = "unseen";
    key.append(document.createElement("i"), "not shown by keypoints");
    now.append(key);
  }
  const parts = curves.map(partsOf);
  const table = [Array.from(data.time), ...parts.flat().flatMap(({ columns }) => columns)];
  const build = () => {
    const colours = theme();
    const series = [{}];
    const bands = [];
    for (const [index, curve] of curves.entries()) {
      const colour = curve.colour(colours);
      keys[index].swatch.style.background = colour;
      for (const { shown } of parts[index]) {
        series.push(shown ? { stroke: colour, width: 1.6, points: { show: data.frames < 2 } } : { stroke: faint(colour, 0.7), width: 1.2, dash: [4, 3], points: { show: false } });
        if (!curve.band) continue;
        const edge = { stroke: "transparent", width: 0, points: { show: false } };
        bands.push({ series: [series.length + 1, series.length], fill: faint(colour, shown ? 0.22 : 0.08) });
        series.push(edge, edge);
      }
    }
    const axis = { stroke: colours.quiet, grid: { stroke: colours.line, width: 1 }, ticks: { stroke: colours.line, size: 4 }, font: "11px system-ui, sans-serif" };
    const options = {
      width: Math.max(160, figure.clientWidth), height: PLOT_HEIGHT, series, bands, legend: { show: false },
      scales: { x: { time: false } },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((tick) => `${+tick.toFixed(3)} s`) }, { ...axis, size: 46, splits: (_, __, low, high, step) => ticksIn(low, high, step), values: (_, ticks) => ticks.map((tick) => `${+tick.toFixed(6)}`.replace("-", "−")) }],
      padding: [6, 10, 0, 0],
      cursor: { drag: { x: false, y: false }, points: { show: false }, y: false, x: false },
    };
    chart?.destroy();
    chart = new uPlot(options, table, figure);
    chart.over.append(line);
    listen(chart);
    show(frame);
  };
  const listen = (chart) => {
    const frameAt = (event) => chart.posToIdx(event.clientX - chart.over.getBoundingClientRect().left);
    chart.over.addEventListener("pointerdown", (event) => {
      chart.over.setPointerCapture(event.pointerId);
      seek(frameAt(event), true);
    });
    chart.over.addEventListener("pointermove", (event) => seek(frameAt(event), event.buttons > 0));
  };
  const show = (at) => {
    frame = at;
    if (!chart) return;
    line.style.transform = `translateX(${chart.valToPos(data.time[at], "x")}px)`;
    curves.forEach(({ name, band, values, digits, unit }, index) => {
      const number = (value) => (Number.isFinite(value) ? value.toFixed(digits).replace("-", "−") : "–");
      const text = band ? `${number(band.mean[at])}${unit} (${number(band.low[at])} to ${number(band.high[at])})` : `${number(values[at])}${unit}`;
      keys[index].words.textContent = name ? `${name} ${text}` : text;
    });
  };
  const range = (values) => values.reduce(([low, high], x) => (Number.isFinite(x) ? [Math.min(low, x), Math.max(high, x)] : [low, high]), [Infinity, -Infinity]);
  const spoken = curves.map(({ name, band, values, seen, digits, unit }) => {
    const [low, high] = range(Array.from(band ? band.mean : values));
    const unseen = unseenShare(seen) > 0 ? `, not shown by keypoints in ${Math.ceil(100 * unseenShare(seen))} % of the frames` : "";
    return `${name || "mean"} from ${low.toFixed(digits)} to ${high.toFixed(digits)}${unit}${unseen}`;
  });
  build();
  chart.root.setAttribute("role", "img");
  chart.root.setAttribute("aria-label", `${title}: ${spoken.join(", ")}`);
  new ResizeObserver(() => {
    if (figure.clientWidth > 0 && Math.abs(figure.clientWidth - chart.width) > 1) {
      chart.setSize({ width: figure.clientWidth, height: PLOT_HEIGHT });
      show(frame);
    }
  }).observe(figure);
  return { show, repaint: build, figure };
}

/** Angles by group: both sides of a joint about one axis in one plot. Those that keypoints mostly do not show come last. */
function angleGroups(data) {
  const groups = new Map();
  for (const angle of [...data.angles].sort((a, b) => a.rank - b.rank)) {
    if (!groups.has(angle.of)) groups.set(angle.of, []);
    groups.get(angle.of).push(angle);
  }
  const isHidden = ([, angles]) => angles.some(({ seen }) => unseenShare(seen) > 0.5);
  const all = [...groups];
  return [...all.filter((group) => !isHidden(group)), ...all.filter(isHidden)].map(([title, angles]) => ({
    title,
    names: angles.map((angle) => angle.name).join(", "),
    curves: angles.map((angle) => ({ name: angle.side === "middle" ? "" : angle.side, colour: (colours) => colours[angle.side], band: angle.band, seen: angle.seen, unit: "°", digits: 1 })),
  }));
}

/** The three coordinates of a point. */
function pointCurves(point) {
  return point.axes.map((band, k) => ({
    title: `${point.name} ${"xyz"[k]}`,
    curves: [{ name: "", colour: (colours) => colours[point.side], band, unit: " m", digits: 3 }],
  }));
}

/** Residuals of all cameras in one plot. */
function residualCurves(data) {
  const colour = (index) => () => CAMERA_COLOURS[index % CAMERA_COLOURS.length];
  return data.cameras.map((camera, index) => ({ name: camera.name, colour: colour(index), values: data.residuals[index], unit: " px", digits: 1 }));
}
