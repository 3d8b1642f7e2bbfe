// The page: the top in space, its curves, the cubic, the inputs and the numbers.
// DATA holds the scene, the shipped scenes, the inputs and the keys; `motionOf` computes.

const at = Object.fromEntries([...document.querySelectorAll("[id]")].map((part) => [part.id, part]));
const DEGREES = 180 / Math.PI;
const ANGLES = { theta: ["ϑ", "blue"], phi: ["φ", "red"], psi: ["ψ", "green"] };
const TITLES = { theta: "ϑ (°)", phi: "φ less its mean rate (°)", psi: "ψ (°)" };
const text = (x, digits = 7) => String(Number(x.toPrecision(digits))).replace(/-/g, "−");
const number = (word) => (word.trim() ? Number(word.replace("−", "-").replace(",", ".")) : NaN);
const even = (from, to, count) =>
  Array.from({ length: count + 1 }, (_, i) => from + ((to - from) * i) / (count || 1));
const timeUnit = DATA.units.time === "time" ? "time unit" : DATA.units.time;
const withUnit = (unit) => (/mass|len/.test(unit) || !unit ? "" : ` (${unit})`);

let scene = {};
let motion = null;
let curves = null;
let [t, playing, pace, fresh] = [0, false, 1, false];
const camera = { azimuth: -62, elevation: 20, zoom: 1 };
const colours = {};

// --- drawing

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["paper", "ink", "quiet", "faint", "blue", "red", "green", "trace"]) {
    colours[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

/** A cleared canvas with its pen, its size in pixels of the page, and the size of its letters. */
function prepared(canvas) {
  const fine = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * fine)) canvas.width = Math.round(width * fine);
  if (canvas.height !== Math.round(height * fine)) canvas.height = Math.round(height * fine);
  const pen = canvas.getContext("2d");
  pen.setTransform(fine, 0, 0, fine, 0, 0);
  pen.clearRect(0, 0, width, height);
  const letters = document.fullscreenElement ? 24 : 13;
  pen.font = `${letters}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textBaseline = "middle";
  return { pen, width, height, letters };
}

/** Draw a line through points; a null point interrupts it. */
function line(pen, points, strokeStyle, { width = 1, dash = [], alpha = 1 } = {}) {
  Object.assign(pen, { strokeStyle, lineWidth: width, globalAlpha: alpha });
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

function area(pen, points, fillStyle) {
  pen.fillStyle = fillStyle;
  pen.beginPath();
  points.forEach((point) => pen.lineTo(...point));
  pen.fill();
}

function word(pen, letters, [x, y], fillStyle, textAlign = "center") {
  Object.assign(pen, { fillStyle, textAlign });
  pen.fillText(letters, x, y);
}

/** Steps of 1, 2 or 5 times a power of ten between two numbers. */
function ticks(low, high, most) {
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const size = [1, 2, 5, 10].map((n) => n * power).find((x) => (high - low) / x <= most + 1);
  const [first, last] = [Math.ceil(low / size), Math.floor(high / size)];
  return last < first ? [] : even(first, last, last - first).map((n) => n * size);
}

// --- space

const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
const sum = (...terms) =>
  [0, 1, 2].map((i) => terms.reduce((total, [x, v]) => total + x * v[i], 0));

/** The line of nodes, the figure axis, and the direction across both. */
function frameOf(theta, psi) {
  const [st, ct, sp, cp] = [Math.sin(theta), Math.cos(theta), Math.sin(psi), Math.cos(psi)];
  return { nodes: [cp, sp, 0], axis: [st * sp, -st * cp, ct], across: [-ct * sp, ct * cp, st] };
}

/** The camera; zoomed in, it follows the mean motion of the axis. */
function viewOf(width, height) {
  const [az, el] = [camera.azimuth / DEGREES, camera.elevation / DEGREES];
  const [sa, ca, se, ce] = [Math.sin(az), Math.cos(az), Math.sin(el), Math.cos(el)];
  const [right, up, toward] = [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
  const scale = (camera.zoom * Math.min(width, height)) / 2.5;
  const follow = Math.min(Math.max(camera.zoom - 1.5, 0), 1);
  const middle = sum([follow, frameOf(curves.tilt, curves.turn * t).axis]);
  const place = (p) => {
    const off = sum([1, p], [-1, middle]);
    return [width / 2 + scale * dot(off, right), height / 2 - scale * dot(off, up)];
  };
  const lamp = sum([0.55, toward], [-0.45, right], [0.5, up]);
  return { scale, place, depth: (p) => dot(p, toward), lamp };
}

const PROFILE = [[0, 0], [0.03, 0.1], [0.07, 0.3], [0.34, 0.44], [0.39, 0.5], [0.36, 0.56],
  [0.08, 0.62], [0.05, 0.84], [0, 0.86]];  // radius and height
const SECTORS = 30;

/** The faces of the top, from back to front, each with its points and its colour. */
function facesOf(frame, phi, { place, depth, lamp }, blur) {
  const ring = PROFILE.map(([radius, height]) => even(0, 2 * Math.PI, SECTORS).map((x) => sum(
    [radius * Math.cos(x + phi), frame.nodes],
    [radius * Math.sin(x + phi), frame.across],
    [height, frame.axis],
  )));
  const faces = [];
  for (let j = 0; j + 1 < PROFILE.length; j += 1) {
    for (let i = 0; i < SECTORS; i += 1) {
      const corners = [ring[j][i], ring[j][i + 1], ring[j + 1][i + 1], ring[j + 1][i]];
      const [dr, dz] = [0, 1].map((k) => PROFILE[j + 1][k] - PROFILE[j][k]);
      const angle = phi + (2 * Math.PI * (i + 0.5)) / SECTORS;
      const [outward, size] = [dz, Math.hypot(dr, dz)];
      const normal = sum(
        [(outward / size) * Math.cos(angle), frame.nodes],
        [(outward / size) * Math.sin(angle), frame.across],
        [-dr / size, frame.axis],
      );
      if (depth(normal) <= 0) continue;
      const light = 34 + 40 * Math.max(dot(normal, lamp), 0);
      const isMark = i < 5 && j > 1 && j < 6;  // a sector that shows the spin
      const saturation = isMark ? 85 - 60 * blur : 12;
      const tint = `hsl(25 ${saturation}% ${light}%)`;
      const middle = corners.reduce((total, p) => total + depth(p), 0);
      faces.push([middle, corners.map(place), tint]);
    }
  }
  return faces.sort((x, y) => x[0] - y[0]);
}

function drawSpace() {
  const { pen, width, height, letters } = prepared(at.space);
  const view = viewOf(width, height);
  const { place, depth, scale } = view;
  const { theta, phi, psi } = motion.angles(t);
  const frame = frameOf(theta, psi);
  const { ink, quiet, faint, blue, red, green, trace } = colours;
  const circle = even(0, 2 * Math.PI, 120);
  const [x0, y0] = place([0, 0, 0]);
  area(pen, circle.map((x) => [x0 + scale * Math.cos(x), y0 + scale * Math.sin(x)]), faint);
  const passed = curves.times.findIndex((time) => time > t);
  const path = curves.axes.slice(0, passed < 0 ? undefined : passed);
  function half(isNear) {
    const side = (points, tint, style = {}) => {
      const seen = points.map((p) => (depth(p) >= 0 === isNear ? place(p) : null));
      line(pen, seen, tint, isNear ? style : { ...style, dash: [3, 3], alpha: 0.4 });
    };
    side(circle.map((x) => frameOf(Math.PI / 2, x).axis), quiet);
    const { theta_min_deg: least, theta_max_deg: most } = motion.record;
    side(circle.map((x) => frameOf(least / DEGREES, x).axis), blue);
    side(circle.map((x) => frameOf(most / DEGREES, x).axis), blue, { dash: [9, 3, 2, 3] });
    side(path, trace, { width: 2.2 });
    for (const [name, axis] of Object.entries({ x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] })) {
      if (depth(axis) >= 0 === isNear) {
        line(pen, [[0, 0, 0], sum([1.15, axis])].map(place), quiet);
        word(pen, name, place(sum([1.2, axis])), quiet);
      }
    }
  }
  half(false);
  const axle = [sum([0.86, frame.axis]), frame.axis].map(place);
  if (depth(frame.axis) < 0) line(pen, axle, ink, { width: 1.6 });
  const blur = playing ? Math.min((Math.abs(scene.r0) * speed()) / 60, 1) : 0;
  for (const [, points, tint] of facesOf(frame, phi, view, blur)) {
    area(pen, points, tint);
    line(pen, [...points, points[0]], tint, { width: 0.6 });
  }
  if (depth(frame.axis) >= 0) line(pen, axle, ink, { width: 1.6 });
  half(true);
  if (at.arcs.checked) {
    line(pen, [[0, 0, 0], frame.nodes].map(place), green, { dash: [6, 3] });
    const arc = (name, angle, tint, point) => {
      const shown = angle % (2 * Math.PI);
      line(pen, even(0, shown, 40).map((x) => place(point(x))), tint, { width: 2 });
      word(pen, name, place(sum([1.14, point(shown / 2)])), tint);
    };
    arc("ψ", psi, green, (x) => [0.55 * Math.cos(x), 0.55 * Math.sin(x), 0]);
    arc("ϑ", theta, blue, (x) => sum([0.95, frameOf(x, psi).axis]));
    arc("φ", phi, red, (x) => sum([0.45 * Math.cos(x), frame.nodes],
      [0.45 * Math.sin(x), frame.across], [0.5, frame.axis]));
  }
  const shown = Object.entries({ theta, phi, psi });
  at.now.textContent = shown.map(([x, y]) => `${ANGLES[x][0]} = ${text(y * DEGREES)}°`).join("\n");
  at.now.style.fontSize = `${letters}px`;
}

// --- curves and cubic

function drawCurves() {
  const { pen, width, height, letters } = prepared(at.plots);
  const [left, right, foot] = [4.8 * letters, width - 8, height - 2.6 * letters];
  const x = (time) => left + ((time - curves.from) / curves.span) * (right - left);
  const mean = { phi: motion.record.mean_spin_rate ?? 0 };
  Object.entries(ANGLES).forEach(([name, [, tint]], i) => {
    const values = curves.angles.map((angles, j) =>
      (angles[name] - (mean[name] ?? 0) * curves.times[j]) * DEGREES);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const [from, to] = high - low > 1e-7 ? [low, high] : [low - 1, high + 1];
    const [top, bottom] = [(foot * i) / 3 + 1.3 * letters, (foot * (i + 1)) / 3 - 6];
    const y = (value) => bottom - ((value - from) / (to - from)) * (bottom - top);
    for (const tick of ticks(from, to, 4)) {
      word(pen, text(tick, 6), [left - 6, y(tick)], colours.ink, "right");
      line(pen, [[left - 3, y(tick)], [left, y(tick)]], colours.quiet);
    }
    word(pen, TITLES[name], [left + 4, top - 0.6 * letters], colours[tint], "left");
    line(pen, values.map((value, j) => [x(curves.times[j]), y(value)]), colours[tint], { width: 1.8 });
  });
  for (const tick of ticks(curves.from, curves.from + curves.span, 5)) {
    word(pen, text(tick, 6), [x(tick), foot + 0.7 * letters], colours.ink);
  }
  word(pen, `t (${timeUnit})`, [(left + right) / 2, foot + 1.9 * letters], colours.ink);
  line(pen, [[x(t), 4], [x(t), foot]], colours.trace, { width: 1.5 });
  curves.timeAt = (place) => curves.from + ((place - left) / (right - left)) * curves.span;
}

function drawCubic() {
  const { pen, width, height, letters } = prepared(at.cubic);
  const { u1, u2, u3 } = motion.record;
  const [left, right, top, bottom] = [4.8 * letters, width - 8, 1.6 * letters, height - 2.6 * letters];
  const last = u3 !== null && u3 - u1 < 1.5 * (u1 - u2) ? u3 : u1;
  const room = 0.35 * (last - u2) || 0.2;
  const points = even(u2 - room, last + room, 200).map((u) => [u, motion.f(u)]);
  const hump = Math.max(...points.filter(([u]) => u >= u2 && u <= u1).map(([, f]) => f), 0);
  const most = hump || Math.max(...points.map(([, f]) => Math.abs(f))) || 1;
  const x = (u) => left + ((u - u2 + room) / (last - u2 + 2 * room)) * (right - left);
  const y = (f) => (top + bottom) / 2 - (f / (1.3 * most)) * ((bottom - top) / 2);
  pen.save();
  pen.beginPath();
  pen.rect(left, top - 8, right - left, bottom - top + 16);
  pen.clip();
  const inside = points.filter(([u]) => u >= u2 && u <= u1).map(([u, f]) => [x(u), y(f)]);
  area(pen, [[x(u2), y(0)], ...inside, [x(u1), y(0)]], colours.faint);
  line(pen, points.map(([u, f]) => [x(u), y(f)]), colours.blue, { width: 1.8 });
  pen.restore();
  line(pen, [[left, y(0)], [right, y(0)]], colours.quiet);
  for (const tick of ticks(-most, most, 3)) {
    word(pen, text(tick, 3), [left - 6, y(tick)], colours.ink, "right");
  }
  for (const tick of ticks(u2 - room, last + room, 4)) {
    word(pen, text(tick, 4), [x(tick), bottom + 0.7 * letters], colours.ink);
  }
  for (const [name, u] of Object.entries({ "u₂": u2, "u₁": u1, "u₃": last === u3 ? u3 : null })) {
    if (u === null || (name === "u₁" && u1 === u2)) continue;
    area(pen, even(0, 2 * Math.PI, 12).map((k) => [x(u) + 3 * Math.cos(k), y(0) + 3 * Math.sin(k)]), colours.ink);
    const label = u1 === u2 ? "u₁ = u₂" : name;
    word(pen, label, [x(u) + (name === "u₃" ? 9 : -9), y(0) - 11], colours.ink);
  }
  const u = Math.cos(motion.angles(t).theta);
  area(pen, even(0, 2 * Math.PI, 16).map((k) => [x(u) + 6 * Math.cos(k), y(motion.f(u)) + 6 * Math.sin(k)]), colours.trace);
  word(pen, "f(u) = u̇²", [left + 4, 0.8 * letters], colours.blue, "left");
  word(pen, "u = cos ϑ", [(left + right) / 2, bottom + 1.9 * letters], colours.ink);
}

// --- scene, time and camera

/** Sample the curves around the present time. */
function sample() {
  const span = 4 * motion.span;
  const from = Math.floor(t / span) * span;
  const times = even(from, from + span, 1200);
  const angles = times.map(motion.angles);
  const { theta_min_deg: low, theta_max_deg: high, mean_precession_rate: turn } = motion.record;
  curves = {
    from,
    span,
    times,
    angles,
    axes: angles.map(({ theta, psi }) => frameOf(theta, psi).axis),
    tilt: (low + high) / 2 / DEGREES,
    turn: turn ?? 0,
  };
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
for (const [name, { symbol, name: meaning, unit }] of Object.entries(DATA.inputs)) {
  const row = Object.assign(document.createElement("div"), { className: "input" });
  const label = document.createElement("label");
  const field = Object.assign(document.createElement("input"), { type: "text", id: `field-${name}` });
  const slider = Object.assign(document.createElement("input"), { type: "range", step: "any" });
  label.htmlFor = field.id;
  label.textContent = `${symbol}  ${meaning}${withUnit(unit)}`;
  field.inputMode = "decimal";
  slider.ariaLabel = `${meaning}, slider`;
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
    if (sign === "positive" && !(x > 0)) return `${symbol} must be positive`;
    if (sign === "not negative" && x < 0) return `${symbol} must not be negative`;
  }
  if (given.C > 2 * given.A) return `C must be at most 2A = ${text(2 * given.A)}`;
  const isTilt = given.theta0_deg >= 0 && given.theta0_deg <= 180;
  if (!isTilt) return `ϑ0 must be from 0° to 180°`;
  return given.theta0_deg % 180 === 0 && given.psidot0 ? "a vertical axis has no ψ̇0" : "";
}

/** Change some inputs, unless they are impossible; `anew` sets the ends of the sliders. */
function change(changes, anew = false) {
  const given = { ...scene, ...changes };
  at.error.textContent = complaint(given);
  document.body.classList.toggle("bad", Boolean(at.error.textContent));
  if (at.error.textContent) return;
  scene = given;
  motion = motionOf(scene);
  for (const [name, { field, slider }] of Object.entries(fields)) {
    if (anew) [slider.min, slider.max] = rangeOf(name, scene[name]);
    field.value = scene[name];
    slider.value = scene[name];
  }
  if (anew) pace = motion.span / 2.5;
  at.words.textContent = sentence(motion, timeUnit);
  at.sketch.hidden = !motion.isSketch;
  const rows = Object.entries(motion.record).filter(([, x]) => x !== null);
  at.record.replaceChildren(...rows.map(([name, x]) => {
    const { symbol, meaning, unit, formula } = DATA.keys[name];
    const row = document.createElement("tr");
    const [, what, value] = [symbol, meaning, `${text(x)} ${unit}`].map((words) => {
      const cell = row.insertCell();
      cell.textContent = words;
      return cell;
    });
    what.append(Object.assign(document.createElement("small"), { textContent: formula }));
    value.title = formula;
    return row;
  }));
  stale();
}

const speed = () => pace * 10 ** Number(at.speed.value);

function stale() {
  curves = null;
  fresh = false;
}

function setTime(time) {
  if (Number.isFinite(time)) t = Math.max(time, 0);
  fresh = false;
}

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

function zoom(factor) {
  camera.zoom = Math.max(0.5, Math.min(400, camera.zoom * factor));
  fresh = false;
}

function resetView() {
  Object.assign(camera, { azimuth: -62, elevation: 20, zoom: 1 });
  fresh = false;
}

function fullScreen() {
  if (document.fullscreenElement) document.exitFullscreen();
  else at.stage.requestFullscreen();
}

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
at.play.addEventListener("click", () => play(!playing));
at.restart.addEventListener("click", () => setTime(0));
at.reset.addEventListener("click", resetView);
at.full.addEventListener("click", fullScreen);
at.time.addEventListener("change", () => setTime(number(at.time.value)));
at.scrub.addEventListener("input", () => setTime((Number(at.scrub.value) * motion.span) / 10));
at.arcs.addEventListener("change", stale);
at.plots.addEventListener("pointermove", (event) => {
  if (event.buttons) setTime(curves.timeAt(event.offsetX));
});
at.space.addEventListener("pointerdown", (event) => at.space.setPointerCapture(event.pointerId));
at.space.addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  camera.azimuth -= event.movementX * 0.5;
  camera.elevation = Math.max(-90, Math.min(90, camera.elevation + event.movementY * 0.5));
  fresh = false;
});
at.space.addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(event.deltaY < 0 ? 1.1 : 1 / 1.1);
}, { passive: false });
for (const kind of ["change", "pointerup", "wheel"]) document.addEventListener(kind, link);
document.addEventListener("keydown", (event) => {
  if (event.target.closest("input, select, button") || !(event.key in KEYS)) return;
  event.preventDefault();
  KEYS[event.key]();
});
at.scenes.append(...["this scene", ...Object.keys(DATA.scenes)].map((name) => new Option(name)));
at.scenes.value = DATA.name in DATA.scenes ? DATA.name : "this scene";
at.scenes.addEventListener("change", () => {
  change(DATA.scenes[at.scenes.value]?.inputs ?? DATA.scene, true);
  at.scenes.title = DATA.scenes[at.scenes.value]?.remark ?? "";
  setTime(0);
});
new ResizeObserver(stale).observe(document.body);
document.addEventListener("fullscreenchange", stale);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readColours(); stale(); });
window.addEventListener("hashchange", restore);

readColours();
const isLinked = restore();
play(!isLinked && !matchMedia("(prefers-reduced-motion: reduce)").matches);
let last = performance.now();
requestAnimationFrame(function frame(now) {
  if (playing) t += speed() * Math.min((now - last) / 1000, 0.1);
  if (playing || !fresh) draw();
  last = now;
  requestAnimationFrame(frame);
});
