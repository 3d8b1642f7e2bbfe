// The page: the top in space, its curves, the inputs and the numbers.
// DATA holds the scene, the built-in scenes, the inputs and the keys; `motionOf` computes.

const at = Object.fromEntries([...document.querySelectorAll("[id]")].map((part) => [part.id, part]));
const CURVES = {
  theta: ["ϑ", "ϑ (°)", "blue"],
  phi: ["φ", "periodic part of φ (°)", "red"],
  psi: ["ψ", "ψ (°)", "green"],
};
const text = (x, digits = 7) => String(Number(x.toPrecision(digits))).replace(/-/g, "−");
const number = (word) => (word.trim() ? Number(word.replace("−", "-").replace(",", ".")) : NaN);
const even = (from, to, n) => Array.from({ length: n + 1 }, (_, i) => from + ((to - from) * i) / (n || 1));
const circle = even(0, 2 * Math.PI, 120);
/** The name of a unit; a built-in scene has none of its own. */
const unitOf = (unit) => (unit === "angle" ? "°" : at.scenes.value in DATA.scenes ? unit : DATA.units[unit]);
/** The name of an input, or the meaning of a key, with its unit if that is known. */
function titleOf({ name, meaning, unit }) {
  const shown = unitOf(unit);
  return (name ?? meaning) + (!shown || /mass|len/.test(shown) ? "" : ` (${shown})`);
}
const style = getComputedStyle(document.documentElement);  // follows the dark mode
const colour = (name) => style.getPropertyValue(`--${name}`) || name;
const FRONT = { azimuth: -62, elevation: 20, zoom: 1 };
const camera = { ...FRONT };

let scene = {};
let draft = {};  // the typed inputs: the scene, unless it is impossible
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
  const font = `${letters}px system-ui, "DejaVu Sans", sans-serif`;
  Object.assign(pen, { font, textBaseline: "middle", lineJoin: "round" });
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

/** Write on a rim of paper, which keeps the letters clear of curves. */
function word(pen, letters, [x, y], tint, textAlign = "center") {
  Object.assign(pen, { fillStyle: colour(tint), strokeStyle: colour("paper"), lineWidth: 4, textAlign });
  pen.setLineDash([]);
  pen.strokeText(letters, x, y);
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

/** What the camera shows. */
function viewOf(width, height) {
  const { nodes, axis, across } = frameOf((90 - camera.elevation) / DEGREE, (camera.azimuth + 90) / DEGREE);
  const scale = (camera.zoom * Math.min(width, height)) / 2.5;
  const place = (p) => [width / 2 + scale * dot(p, nodes), height / 2 - scale * dot(p, across)];
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
  const { pen, width, height } = prepared(at.space);
  const view = viewOf(width, height);
  const { scale, place, depth } = view;
  const angles = motion.angles(t);
  const { theta, phi, psi } = angles;
  const frame = frameOf(theta, psi);
  area(pen, circle.map((x) => [width / 2 + scale * Math.cos(x), height / 2 + scale * Math.sin(x)]), "faint");
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
    side(circle.map((x) => frameOf(least / DEGREE, x).axis), "blue");
    side(circle.map((x) => frameOf(most / DEGREE, x).axis), "blue", { dash: [9, 3, 2, 3] });
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
  line(pen, [[0, 0, 0], frame.nodes].map(place), "green", { dash: [6, 3] });
  const points = {
    psi: (x) => [0.8 * Math.cos(x), 0.8 * Math.sin(x), 0],
    theta: (x) => sum([0.95, frameOf(x, psi).axis]),
    phi: (x) => around(frame, 0.45, x, 0.5),
  };
  for (const [name, point] of Object.entries(points)) {
    const [symbol, , tint] = CURVES[name];
    const shown = angles[name] % (2 * Math.PI);
    line(pen, even(0, shown, 40).map((x) => place(point(x))), tint, { width: 2 });
    word(pen, symbol, place(sum([1.14, point(shown / 2)])), tint);
  }
  at.now.textContent = Object.entries(angles).map(([x, y]) => `${CURVES[x][0]} = ${text(y * DEGREE)}°`).join("\n");
}

// --- curves

function drawCurves() {
  const { pen, width, height, letters } = prepared(at.plots);
  const [left, right, foot] = [4.8 * letters, width - 8, height - 2.2 * letters];
  const { from, span, times } = curves;
  const across = (time) => left + ((time - from) / span) * (right - left);
  const spin = motion.record.mean_spin_rate ?? 0;
  Object.entries(CURVES).forEach(([name, [, title, tint]], i) => {
    const values = curves.angles.map((angles, j) => (angles[name] - (name === "phi" ? spin * times[j] : 0)) * DEGREE);
    let [low, high] = [Math.min(...values), Math.max(...values)];
    if (high - low < 1e-7) [low, high] = [low - 1, high + 1];
    const [top, bottom] = [(foot * i) / 3 + 1.3 * letters, (foot * (i + 1)) / 3 - 6];
    const down = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
    for (const value of ticks(low, high, clamped(Math.floor((bottom - top) / (2 * letters)), 1, 4))) {
      word(pen, text(value), [left - 6, down(value)], "ink", "right");
      line(pen, [[left - 3, down(value)], [left, down(value)]], "quiet");
    }
    line(pen, values.map((value, j) => [across(times[j]), down(value)]), tint, { width: 1.8 });
    line(pen, [[across(t), top], [across(t), bottom]], "trace", { width: 1.5 });
    word(pen, title, [left + 4, top - 0.7 * letters], tint, "left");
  });
  for (const time of ticks(from, from + span, 5)) word(pen, text(time), [across(time), foot + 0.2 * letters], "ink");
  word(pen, `t (${unitOf("time").replace("time", "time units")})`, [(left + right) / 2, foot + 1.5 * letters], "ink");
  curves.timeAt = (place) => from + ((place - left) / (right - left)) * span;
}

// --- scene, time and camera

/** Sample the curves around the present time. */
function sample() {
  const span = 4 * motion.span;
  const from = Math.floor(t / span) * span;
  const times = even(from, from + span, 800);
  const angles = times.map(motion.angles);
  const axes = angles.map(({ theta, psi }) => frameOf(theta, psi).axis);
  curves = { from, span, times, angles, axes };
}

function draw() {
  fresh = true;
  if (!curves || t < curves.from || t >= curves.from + curves.span) sample();
  drawSpace();
  if (!document.fullscreenElement) drawCurves();
  if (document.activeElement !== at.time && !at.time.classList.contains("wrong")) at.time.value = text(t, 6);
}

const make = (tag, parts) => Object.assign(document.createElement(tag), parts);
const fields = {};
for (const [name, input] of Object.entries(DATA.inputs)) {
  const label = make("label", { htmlFor: `field-${name}` });
  const field = make("input", { type: "text", id: `field-${name}`, inputMode: "decimal" });
  const slider = make("input", { type: "range", step: "any", ariaLabel: `${input.name}, slider` });
  const row = make("div", { className: "input" });
  row.append(label, field, slider);
  at.inputs.append(row);
  fields[name] = { label, field, slider };
  field.addEventListener("change", () => change({ [name]: number(field.value) }, true));
  slider.addEventListener("input", () => {
    const rounded = Number(Number(slider.value).toPrecision(4));
    change({ [name]: clamped(rounded, Number(slider.min), Number(slider.max)) });
  });
}

/** The ends of a slider around a value; those of A and C depend on each other. */
function rangeOf(name, x) {
  const { A, C, m, g, s } = scene;
  if (name === "theta0_deg") return [0, 180];
  if (name === "C") return [A / 100, Math.max(2 * A, C)];
  if (!name.endsWith("0")) return ["s", "g"].includes(name) ? [0, 3 * x || 1] : [x / 100, 3 * x];
  const rate = Math.sqrt((2 * m * g * s) / A) || 1;
  const most = Math.max(1.5 * Math.abs(x), name === "r0" ? (2.5 * rate * A) / C : rate);
  return [-most, most];
}

/** The input that makes a scene impossible, why, and a change that mends it; or nothing. */
function complaint(given) {
  const { m, A, C, s, g, theta0_deg: tilt, psidot0 } = given;
  const outside = {
    m: m <= 0, A: A <= 0, C: C <= 0 || (C > 2 * A && DATA.units.time !== "time"), s: s < 0, g: g < 0, theta0_deg: tilt < 0 || tilt > 180,
  };
  for (const [name, { symbol, bound }] of Object.entries(DATA.inputs)) {
    if (!Number.isFinite(given[name])) return [name, `${symbol} must be a number`];
    if (outside[name]) return [name, `${symbol} must be ${bound}`];
  }
  return tilt % 180 === 0 && psidot0 ? ["psidot0", "ψ'0 must be 0 if the axis is vertical.", { psidot0: 0 }] : [];
}

/** Say what is wrong with a field, or nothing; the button beside it makes the changes of `remedy`. */
function say(field, words = "", remedy = null) {
  document.querySelectorAll(".wrong").forEach((each) => each.classList.remove("wrong"));
  if (words) field.classList.add("wrong");
  [at.error.textContent, at.fix.hidden, at.fix.onclick] = [words, !remedy, () => change(remedy, true)];
}

/** Change some inputs, and the motion if they are possible; `anew` sets the ends of the sliders. */
function change(changes, anew = false) {
  const isEdit = Object.entries(changes).some(([name, x]) => x !== draft[name]);
  draft = { ...draft, steady: draft.steady && !isEdit, ...changes };
  const [wrong, words, remedy] = complaint(draft);
  say(fields[wrong]?.field, words, remedy);
  if (document.body.classList.toggle("bad", Boolean(wrong))) return;
  scene = draft;
  motion = motionOf(scene);
  for (const [name, { label, field, slider }] of Object.entries(fields)) {
    label.textContent = `${DATA.inputs[name].symbol}  ${titleOf(DATA.inputs[name])}`;
    if (anew || name === "C") [slider.min, slider.max] = rangeOf(name, scene[name]);
    if (name === "A" && scene.C <= 2 * scene.A) slider.min = Math.max(slider.min, scene.C / 2);
    [field.value, slider.value] = [Number(scene[name].toPrecision(7)), scene[name]];
  }
  if (anew) pace = motion.span / 2.5;
  at.words.textContent = sentence(motion, DATA.phrases, unitOf("time"));
  const notes = [motion.doubt && `sketch: ${motion.doubt} (use lagtop solve)`];
  if (scene.C > 2 * scene.A) notes.push("no rigid body has C > 2A");
  at.sketch.textContent = notes.filter(Boolean).join("; ");
  at.sketch.hidden = !at.sketch.textContent;
  nameScenes();
  at.record.replaceChildren();
  for (const [name, x] of Object.entries(motion.record).filter(([, value]) => value !== null)) {
    const row = at.record.insertRow();
    for (const words of [DATA.keys[name].symbol, titleOf(DATA.keys[name]), text(x)]) row.insertCell().textContent = words;
  }
  curves = null;
}

/** Mark the scene of the menu as edited if its inputs are others now. */
function nameScenes() {
  const own = DATA.scenes[at.scenes.value] ?? DATA.scene;
  const isEdited = Object.keys(DATA.inputs).some((name) => own[name] !== scene[name]);
  for (const option of at.scenes.options) {
    option.textContent = option.value + (isEdited && option.selected ? " (edited)" : "");
  }
}

const redraw = () => { fresh = false; };
const speed = () => pace * 10 ** Number(at.speed.value);

function setTime(time) {
  const isTime = Number.isFinite(time) && time >= 0;
  if (isTime) t = time;
  if (!document.body.classList.contains("bad")) say(at.time, isTime ? "" : "t must be a number, at least 0");
}

function play(isOn) {
  playing = isOn;
  at.play.textContent = isOn ? "Pause" : "Play";
  if (!isOn) link();
}

/** Write everything that is shown into the address. */
function link() {
  const { steady, ...inputs } = scene;
  const view = { t, speed: at.speed.value, ...camera, scene: at.scenes.value };
  history.replaceState(null, "", `#${new URLSearchParams({ ...inputs, ...view })}`);
}

/** Show what the address says, or else the scene of the file. */
function restore() {
  const words = new URLSearchParams(location.hash.slice(1));
  const known = Object.fromEntries([...words].map(([name, x]) => [name, number(x)]));
  const isOwn = ([, inputs]) => DATA.units.time === "time" && Object.keys(inputs).every((x) => inputs[x] === DATA.scene[x]);
  const name = words.get("scene") ?? Object.entries(DATA.scenes).find(isOwn)?.[0];
  at.scenes.value = name in DATA.scenes ? name : "this scene";
  change(DATA.scene, true);
  change(Object.fromEntries(Object.entries(known).filter(([name]) => name in DATA.inputs)), true);
  for (const name of Object.keys(camera)) if (Number.isFinite(known[name])) camera[name] = known[name];
  if (Number.isFinite(known.speed)) at.speed.value = known.speed;
  setTime(known.t ?? 0);
  return words.size > 0;
}

const fullScreen = () => (document.fullscreenElement ? document.exitFullscreen() : at.stage.requestFullscreen());
const KEYS = {
  " ": () => play(!playing),
  ArrowRight: () => setTime(t + motion.span / 50),
  ArrowLeft: () => setTime(Math.max(t - motion.span / 50, 0)),
  Home: () => setTime(0),
  f: fullScreen,
};
const on = (part, kinds, act, options) => kinds.split(" ").forEach((kind) => part.addEventListener(kind, act, options));
on(at.play, "click", () => play(!playing));
on(at.restart, "click", () => setTime(0));
on(at.full, "click", fullScreen);
on(at.time, "change", () => setTime(number(at.time.value)));
on(at.plots, "pointermove", (event) => event.buttons && setTime(Math.max(curves.timeAt(event.offsetX), 0)));
on(at.space, "pointerdown", (event) => at.space.setPointerCapture(event.pointerId));
on(at.space, "pointermove", ({ buttons, movementX, movementY }) => {
  if (!buttons) return;
  camera.azimuth -= movementX * 0.5;
  camera.elevation = clamped(camera.elevation + movementY * 0.5, -90, 90);
});
on(at.space, "dblclick", () => Object.assign(camera, FRONT));
on(at.space, "wheel", (event) => {
  event.preventDefault();
  camera.zoom = clamped(camera.zoom * (event.deltaY < 0 ? 1.1 : 1 / 1.1), 0.5, 4);
}, { passive: false });
on(document, "keydown", (event) => {
  if (event.target.closest("input, select, button") || !(event.key in KEYS)) return;
  event.preventDefault();
  KEYS[event.key]();
});
at.scenes.append(...["this scene", ...Object.keys(DATA.scenes)].map((name) => new Option(name, name)));
on(at.scenes, "change", () => {
  change(DATA.scenes[at.scenes.value] ?? DATA.scene, true);
  setTime(0);
});
on(document, "change pointerup wheel", link);
on(window, "hashchange", () => restore());
on(document, "change input click pointermove wheel keydown fullscreenchange", redraw);
on(matchMedia("(prefers-color-scheme: dark)"), "change", redraw);
new ResizeObserver(redraw).observe(document.body);

const isLinked = restore();
play(!isLinked && !matchMedia("(prefers-reduced-motion: reduce)").matches);
let last = performance.now();
requestAnimationFrame(function frame(now) {
  if (playing) t += speed() * Math.min((now - last) / 1000, 0.1);
  if (playing || !fresh || !curves) draw();
  last = now;
  requestAnimationFrame(frame);
});
