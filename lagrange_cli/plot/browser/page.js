// The page: the top in space, its curves, the cubic, the inputs and the numbers.
// DATA holds the scene, the shipped scenes, the inputs and the keys; `motionOf` computes.

const at = Object.fromEntries([...document.querySelectorAll("[id]")].map((part) => [part.id, part]));
const DEGREES = 180 / Math.PI;
const CURVES = {
  theta: ["ϑ", "ϑ (°)", "blue"],
  phi: ["φ", "φ less its mean rate (°)", "red"],
  psi: ["ψ", "ψ (°)", "green"],
};
const text = (x, digits = 7) => String(Number(x.toPrecision(digits))).replace(/-/g, "−");
const number = (word) => (word.trim() ? Number(word.replace("−", "-").replace(",", ".")) : NaN);
const clamped = (x, least, most) => Math.min(Math.max(x, least), most);
const even = (from, to, n) => Array.from({ length: n + 1 }, (_, i) => from + ((to - from) * i) / (n || 1));
const circle = even(0, 2 * Math.PI, 120);
const timeUnit = DATA.time === "time" ? "time unit" : DATA.time;
const style = getComputedStyle(document.documentElement);  // follows the dark mode
const colour = (name) => style.getPropertyValue(`--${name}`) || name;
const camera = { azimuth: -62, elevation: 20, zoom: 1 };

let scene = {};
let motion = null;
let curves = null;
let [t, playing, pace, fresh] = [0, false, 1, false];

// --- drawing

/** A cleared canvas with its pen, its size in pixels of the page, and the size of its letters. */
function prepared(canvas) {
  const fine = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  [canvas.width, canvas.height] = [width * fine, height * fine];
  const pen = canvas.getContext("2d");
  pen.scale(fine, fine);
  const letters = document.fullscreenElement ? 24 : 13;
  Object.assign(pen, { font: `${letters}px system-ui, "DejaVu Sans", sans-serif`, textBaseline: "middle" });
  return { pen, width, height, letters };
}

/** Draw a line through points; a null point interrupts it. */
function line(pen, points, tint, { width = 1, dash = [], alpha = 1 } = {}) {
  Object.assign(pen, { strokeStyle: colour(tint), lineWidth: width, globalAlpha: alpha });
  pen.setLineDash(dash);
  pen.beginPath();
  let isDown = false;
  for (const point of points) {
    if (point) pen[isDown ? "lineTo" : "moveTo"](...point);
    isDown = Boolean(point);
  }
  pen.stroke();
  pen.globalAlpha = 1;
}

function area(pen, points, tint) {
  pen.fillStyle = colour(tint);
  pen.beginPath();
  points.forEach((point) => pen.lineTo(...point));
  pen.fill();
}

function disc(pen, [x, y], radius, tint) {
  area(pen, circle.map((k) => [x + radius * Math.cos(k), y + radius * Math.sin(k)]), tint);
}

function word(pen, letters, [x, y], tint, textAlign = "center") {
  Object.assign(pen, { fillStyle: colour(tint), textAlign });
  pen.fillText(letters, x, y);
}

/** Steps of 1, 2 or 5 times a power of ten between two numbers. */
function ticks(low, high, most) {
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const size = power * [1, 2, 5, 10].find((n) => (high - low) / (n * power) <= most + 1);
  const [first, last] = [Math.ceil(low / size), Math.floor(high / size)];
  return last < first ? [] : even(first, last, last - first).map((n) => n * size);
}

// --- space

const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
const sum = (...terms) => [0, 1, 2].map((i) => terms.reduce((total, [x, v]) => total + x * v[i], 0));

/** The line of nodes, the figure axis, and the direction across both. */
function frameOf(theta, psi) {
  const [st, ct, sp, cp] = [Math.sin(theta), Math.cos(theta), Math.sin(psi), Math.cos(psi)];
  return { nodes: [cp, sp, 0], axis: [st * sp, -st * cp, ct], across: [-ct * sp, ct * cp, st] };
}

/** A point by its cylindrical coordinates about the figure axis. */
const around = ({ nodes, axis, across }, radius, angle, height) =>
  sum([radius * Math.cos(angle), nodes], [radius * Math.sin(angle), across], [height, axis]);

/** The camera; zoomed in, it follows the mean motion of the axis. */
function viewOf(width, height) {
  const { nodes, axis, across } = frameOf((90 - camera.elevation) / DEGREES, (camera.azimuth + 90) / DEGREES);
  const scale = (camera.zoom * Math.min(width, height)) / 2.5;
  const middle = sum([clamped(camera.zoom - 1.5, 0, 1), frameOf(curves.tilt, curves.turn * t).axis]);
  const place = (p) => {
    const off = sum([1, p], [-1, middle]);
    return [width / 2 + scale * dot(off, nodes), height / 2 - scale * dot(off, across)];
  };
  return { scale, place, depth: (p) => dot(p, axis), lamp: sum([0.55, axis], [-0.45, nodes], [0.5, across]) };
}

const PROFILE = [[0, 0], [0.03, 0.1], [0.07, 0.3], [0.34, 0.44], [0.39, 0.5], [0.36, 0.56], [0.08, 0.62], [0.05, 0.84],
  [0, 0.86]];  // radius and height
const SECTORS = 30;

/** The faces of the top, from back to front, each with its depth, its points and its colour. */
function facesOf(frame, phi, { place, depth, lamp }, blur) {
  const angles = even(phi, phi + 2 * Math.PI, SECTORS);
  const rings = PROFILE.map(([radius, height]) => angles.map((angle) => around(frame, radius, angle, height)));
  const faces = [];
  for (let j = 0; j + 1 < PROFILE.length; j += 1) {
    const [dr, dz] = [0, 1].map((k) => PROFILE[j + 1][k] - PROFILE[j][k]);
    const size = Math.hypot(dr, dz);
    for (let i = 0; i < SECTORS; i += 1) {
      const normal = around(frame, dz / size, (angles[i] + angles[i + 1]) / 2, -dr / size);
      if (depth(normal) <= 0) continue;
      const corners = [rings[j][i], rings[j][i + 1], rings[j + 1][i + 1], rings[j + 1][i]];
      const isMark = i < 5 && j > 1 && j < 6;  // a sector that shows the spin
      const tint = `hsl(25 ${isMark ? 85 - 60 * blur : 12}% ${34 + 40 * Math.max(dot(normal, lamp), 0)}%)`;
      faces.push([corners.reduce((total, p) => total + depth(p), 0), corners.map(place), tint]);
    }
  }
  return faces.sort((x, y) => x[0] - y[0]);
}

function drawSpace() {
  const { pen, width, height, letters } = prepared(at.space);
  const view = viewOf(width, height);
  const { place, depth } = view;
  const angles = motion.angles(t);
  const { theta, phi, psi } = angles;
  const frame = frameOf(theta, psi);
  disc(pen, place([0, 0, 0]), view.scale, "faint");
  const passed = curves.times.findIndex((time) => time > t);
  const path = curves.axes.slice(0, passed < 0 ? undefined : passed);
  const axle = [sum([0.86, frame.axis]), frame.axis].map(place);
  function half(isNear) {
    const side = (points, tint, look = {}) => {
      const seen = points.map((p) => (depth(p) >= 0 === isNear ? place(p) : null));
      line(pen, seen, tint, isNear ? look : { ...look, dash: [3, 3], alpha: 0.4 });
    };
    const { theta_min_deg: least, theta_max_deg: most } = motion.record;
    side(circle.map((x) => frameOf(Math.PI / 2, x).axis), "quiet");
    side(circle.map((x) => frameOf(least / DEGREES, x).axis), "blue");
    side(circle.map((x) => frameOf(most / DEGREES, x).axis), "blue", { dash: [9, 3, 2, 3] });
    side(path, "trace", { width: 2.2 });
    for (const [name, axis] of Object.entries({ x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] })) {
      if (depth(axis) >= 0 !== isNear) continue;
      line(pen, [[0, 0, 0], sum([1.15, axis])].map(place), "quiet");
      word(pen, name, place(sum([1.2, axis])), "quiet");
    }
  }
  half(false);
  if (depth(frame.axis) < 0) line(pen, axle, "ink", { width: 1.6 });
  const blur = playing ? Math.min((Math.abs(scene.r0) * speed()) / 60, 1) : 0;
  for (const [, points, tint] of facesOf(frame, phi, view, blur)) {
    area(pen, points, tint);
    line(pen, [...points, points[0]], tint, { width: 0.6 });
  }
  if (depth(frame.axis) >= 0) line(pen, axle, "ink", { width: 1.6 });
  half(true);
  if (at.arcs.checked) {
    line(pen, [[0, 0, 0], frame.nodes].map(place), "green", { dash: [6, 3] });
    const points = {
      psi: (x) => [0.55 * Math.cos(x), 0.55 * Math.sin(x), 0],
      theta: (x) => sum([0.95, frameOf(x, psi).axis]),
      phi: (x) => around(frame, 0.45, x, 0.5),
    };
    for (const [name, point] of Object.entries(points)) {
      const [symbol, , tint] = CURVES[name];
      const shown = angles[name] % (2 * Math.PI);
      line(pen, even(0, shown, 40).map((x) => place(point(x))), tint, { width: 2 });
      word(pen, symbol, place(sum([1.14, point(shown / 2)])), tint);
    }
  }
  at.now.textContent = Object.entries(angles).map(([x, y]) => `${CURVES[x][0]} = ${text(y * DEGREES)}°`).join("\n");
  at.now.style.fontSize = `${letters}px`;
}

// --- curves and cubic

/** The names of ticks at the left and at the foot, each with its place. */
function scales(pen, letters, left, foot, { across = [], up = [] }, digits) {
  for (const [tick, x] of across) word(pen, text(tick, digits), [x, foot + 0.7 * letters], "ink");
  for (const [tick, y] of up) {
    word(pen, text(tick, digits), [left - 6, y], "ink", "right");
    line(pen, [[left - 3, y], [left, y]], "quiet");
  }
}

function drawCurves() {
  const { pen, width, height, letters } = prepared(at.plots);
  const [left, right, foot] = [4.8 * letters, width - 8, height - 2.6 * letters];
  const x = (time) => left + ((time - curves.from) / curves.span) * (right - left);
  const mean = { theta: 0, phi: motion.record.mean_spin_rate ?? 0, psi: 0 };
  Object.entries(CURVES).forEach(([name, [, title, tint]], i) => {
    const values = curves.angles.map((angles, j) => (angles[name] - mean[name] * curves.times[j]) * DEGREES);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const [from, to] = high - low > 1e-7 ? [low, high] : [low - 1, high + 1];
    const [top, bottom] = [(foot * i) / 3 + 1.3 * letters, (foot * (i + 1)) / 3 - 6];
    const y = (value) => bottom - ((value - from) / (to - from)) * (bottom - top);
    scales(pen, letters, left, foot, { up: ticks(from, to, 4).map((tick) => [tick, y(tick)]) }, 6);
    word(pen, title, [left + 4, top - 0.6 * letters], tint, "left");
    line(pen, values.map((value, j) => [x(curves.times[j]), y(value)]), tint, { width: 1.8 });
  });
  const across = ticks(curves.from, curves.from + curves.span, 5).map((tick) => [tick, x(tick)]);
  scales(pen, letters, left, foot, { across }, 6);
  word(pen, `t (${timeUnit})`, [(left + right) / 2, foot + 1.9 * letters], "ink");
  line(pen, [[x(t), 4], [x(t), foot]], "trace", { width: 1.5 });
  curves.timeAt = (place) => curves.from + ((place - left) / (right - left)) * curves.span;
}

function drawCubic() {
  const { pen, width, height, letters } = prepared(at.cubic);
  const { u1, u2, u3 } = motion.record;
  const [left, right, top, bottom] = [4.8 * letters, width - 8, 1.6 * letters, height - 2.6 * letters];
  const last = u3 !== null && u3 - u1 < 1.5 * (u1 - u2) ? u3 : u1;
  const room = 0.35 * (last - u2) || 0.2;
  const points = even(u2 - room, last + room, 200).map((u) => [u, motion.f(u)]);
  const hump = points.filter(([u]) => u >= u2 && u <= u1);
  const most = Math.max(...hump.map(([, f]) => f), 0) || Math.max(...points.map(([, f]) => Math.abs(f))) || 1;
  const x = (u) => left + ((u - u2 + room) / (last - u2 + 2 * room)) * (right - left);
  const y = (f) => (top + bottom) / 2 - (f / (1.3 * most)) * ((bottom - top) / 2);
  const place = ([u, f]) => [x(u), y(f)];
  area(pen, [[u2, 0], ...hump, [u1, 0]].map(place), "faint");
  line(pen, points.map((point) => (Math.abs(point[1]) < 1.4 * most ? place(point) : null)), "blue", { width: 1.8 });
  line(pen, [[left, y(0)], [right, y(0)]], "quiet");
  scales(pen, letters, left, bottom, { up: ticks(-most, most, 3).map((tick) => [tick, y(tick)]) }, 3);
  scales(pen, letters, left, bottom, { across: ticks(u2 - room, last + room, 4).map((tick) => [tick, x(tick)]) }, 4);
  const roots = u1 === u2 ? { "u₁ = u₂": u2 } : { "u₂": u2, "u₁": u1 };
  for (const [name, u] of Object.entries(last === u3 ? { ...roots, "u₃": u3 } : roots)) {
    disc(pen, place([u, 0]), 3, "ink");
    word(pen, name, [x(u) + (name === "u₃" ? 9 : -9), y(0) - 11], "ink");
  }
  const u = Math.cos(motion.angles(t).theta);
  disc(pen, place([u, motion.f(u)]), 6, "trace");
  word(pen, "f(u) = u̇²", [left + 4, 0.8 * letters], "blue", "left");
  word(pen, "u = cos ϑ", [(left + right) / 2, bottom + 1.9 * letters], "ink");
}

// --- scene, time and camera

/** Sample the curves around the present time. */
function sample() {
  const span = 4 * motion.span;
  const from = Math.floor(t / span) * span;
  const times = even(from, from + span, 1200);
  const angles = times.map(motion.angles);
  const axes = angles.map(({ theta, psi }) => frameOf(theta, psi).axis);
  const { theta_min_deg: low, theta_max_deg: high, mean_precession_rate: turn } = motion.record;
  curves = { from, span, times, angles, axes, tilt: (low + high) / 2 / DEGREES, turn: turn ?? 0 };
}

function draw() {
  fresh = true;
  if (!curves || t < curves.from || t >= curves.from + curves.span) sample();
  drawSpace();
  if (!document.fullscreenElement) {
    drawCurves();
    drawCubic();
  }
  if (document.activeElement !== at.time) at.time.value = text(t);
  if (document.activeElement !== at.scrub) at.scrub.value = (t / motion.span) * 10;
}

const fields = {};
for (const [name, { symbol, meaning, unit }] of Object.entries(DATA.inputs)) {
  const make = (tag, parts) => Object.assign(document.createElement(tag), parts);
  const words = `${symbol}  ${meaning}${/mass|len/.test(unit) || !unit ? "" : ` (${unit})`}`;
  const label = make("label", { htmlFor: `field-${name}`, textContent: words });
  const field = make("input", { type: "text", id: `field-${name}`, inputMode: "decimal" });
  const slider = make("input", { type: "range", step: "any", ariaLabel: `${meaning}, slider` });
  const row = make("div", { className: "input" });
  row.append(label, field, slider);
  at.inputs.append(row);
  fields[name] = { field, slider };
  field.addEventListener("change", () => change({ [name]: number(field.value) }, true));
  slider.addEventListener("input", () => change({ [name]: Number(Number(slider.value).toPrecision(4)) }));
}

/** The ends of a slider around a value. */
function rangeOf(name, x) {
  const { A, C, m, g, s } = scene;
  const rate = Math.sqrt((2 * m * g * s) / A) || 1;
  if (name === "theta0_deg") return [0, 180];
  if (name === "C") return [0, 2 * A];
  if (name === "A") return [C / 2, 3 * A];
  const most = name === "r0" ? (2.5 * rate * A) / C : name.endsWith("dot0") ? rate : 0;
  return most ? [-1, 1].map((side) => side * Math.max(1.5 * Math.abs(x), most)) : [0, 3 * x || 1];
}

/** Why a scene is impossible, or an empty text. */
function complaint(given) {
  for (const [name, x] of Object.entries(given)) {
    const { symbol, sign } = DATA.inputs[name];
    if (!Number.isFinite(x)) return `${symbol} must be a number`;
    if (x < 0 ? sign : sign === "be positive" && !x) return `${symbol} must ${sign}`;
  }
  if (given.C > 2 * given.A) return `C must be at most 2A = ${text(2 * given.A)}`;
  if (given.theta0_deg < 0 || given.theta0_deg > 180) return "ϑ0 must be from 0° to 180°";
  return given.theta0_deg % 180 === 0 && given.psidot0 ? "a vertical axis has no ψ̇0" : "";
}

/** Change some inputs, unless they are impossible; `anew` sets the ends of the sliders. */
function change(changes, anew = false) {
  const given = { ...scene, ...changes };
  at.error.textContent = complaint(given);
  if (document.body.classList.toggle("bad", Boolean(at.error.textContent))) return;
  scene = given;
  motion = motionOf(scene);
  for (const [name, { field, slider }] of Object.entries(fields)) {
    if (anew) [slider.min, slider.max] = rangeOf(name, scene[name]);
    [field.value, slider.value] = [scene[name], scene[name]];
  }
  if (anew) pace = motion.span / 2.5;
  at.words.textContent = sentence(motion, timeUnit);
  at.sketch.hidden = !motion.isSketch;
  const shown = Object.entries(motion.record).filter(([, x]) => x !== null);
  at.record.replaceChildren(...shown.map(([name, x]) => {
    const { symbol, meaning, unit, formula } = DATA.keys[name];
    const row = document.createElement("tr");
    for (const words of [symbol, meaning, `${text(x)} ${unit}`]) row.insertCell().textContent = words;
    row.cells[1].append(Object.assign(document.createElement("small"), { textContent: formula }));
    row.cells[2].title = formula;
    return row;
  }));
  stale();
}

const speed = () => pace * 10 ** Number(at.speed.value);

function stale() {
  curves = null;
  fresh = false;
}

const setTime = (time) => { t = Number.isFinite(time) ? Math.max(time, 0) : t; };

function play(isOn) {
  playing = isOn;
  at.play.textContent = isOn ? "Pause" : "Play";
  if (!isOn) link();
}

/** Write everything that is shown into the address. */
function link() {
  const view = { t, speed: at.speed.value, ...camera, arcs: Number(at.arcs.checked) };
  history.replaceState(null, "", `#${new URLSearchParams({ ...scene, ...view })}`);
}

/** Show what the address says, or else the scene of the file. */
function restore() {
  const words = new URLSearchParams(location.hash.slice(1));
  const known = Object.fromEntries([...words].map(([name, x]) => [name, number(x)]));
  const inputs = Object.keys(DATA.inputs).filter((name) => name in known);
  change(DATA.scene, true);
  change(Object.fromEntries(inputs.map((name) => [name, known[name]])), true);
  for (const name of Object.keys(camera)) if (Number.isFinite(known[name])) camera[name] = known[name];
  if (Number.isFinite(known.speed)) at.speed.value = known.speed;
  at.arcs.checked = known.arcs !== 0;
  setTime(known.t ?? 0);
  return words.size > 0;
}

const zoom = (factor) => Object.assign(camera, { zoom: clamped(camera.zoom * factor, 0.5, 400) });
const resetView = () => Object.assign(camera, { azimuth: -62, elevation: 20, zoom: 1 });
const fullScreen = () => (document.fullscreenElement ? document.exitFullscreen() : at.stage.requestFullscreen());
const KEYS = {
  " ": () => play(!playing),
  ArrowRight: () => setTime(t + motion.span / 50),
  ArrowLeft: () => setTime(t - motion.span / 50),
  Home: () => setTime(0),
  "+": () => zoom(1.1),
  "-": () => zoom(1 / 1.1),
  0: resetView,
  f: fullScreen,
};
const on = (part, kinds, act, options) => kinds.split(" ").forEach((kind) => part.addEventListener(kind, act, options));
on(at.play, "click", () => play(!playing));
on(at.restart, "click", () => setTime(0));
on(at.reset, "click", resetView);
on(at.full, "click", fullScreen);
on(at.time, "change", () => setTime(number(at.time.value)));
on(at.scrub, "input", () => setTime((Number(at.scrub.value) * motion.span) / 10));
on(at.plots, "pointermove", (event) => event.buttons && setTime(curves.timeAt(event.offsetX)));
on(at.space, "pointerdown", (event) => at.space.setPointerCapture(event.pointerId));
on(at.space, "pointermove", ({ buttons, movementX, movementY }) => {
  if (!buttons) return;
  camera.azimuth -= movementX * 0.5;
  camera.elevation = clamped(camera.elevation + movementY * 0.5, -90, 90);
});
on(at.space, "wheel", (event) => {
  event.preventDefault();
  zoom(event.deltaY < 0 ? 1.1 : 1 / 1.1);
}, { passive: false });
on(document, "keydown", (event) => {
  if (event.target.closest("input, select, button") || !(event.key in KEYS)) return;
  event.preventDefault();
  KEYS[event.key]();
});
at.scenes.append(...["this scene", ...Object.keys(DATA.scenes)].map((name) => new Option(name)));
on(at.scenes, "change", () => {
  const { inputs, remark } = DATA.scenes[at.scenes.value] ?? { inputs: DATA.scene, remark: "" };
  change(inputs, true);
  at.scenes.title = remark;
  setTime(0);
});
on(document, "change pointerup wheel", link);
on(document, "change input click pointermove wheel keydown", () => { fresh = false; });
on(document, "fullscreenchange", stale);
on(matchMedia("(prefers-color-scheme: dark)"), "change", stale);
on(window, "hashchange", () => restore());
new ResizeObserver(stale).observe(document.body);

const isLinked = restore();
play(!isLinked && !matchMedia("(prefers-reduced-motion: reduce)").matches);
let last = performance.now();
requestAnimationFrame(function frame(now) {
  if (playing) t += speed() * Math.min((now - last) / 1000, 0.1);
  if (playing || !fresh) draw();
  last = now;
  requestAnimationFrame(frame);
});
