// What all drawings share: colours of the style sheet, lines, letters, and numbers along an axis.

const NAMES = "paper ink quiet faint blue red green trace".split(" ");

/** The colours in use, light or dark. */
export function readLook() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  return Object.fromEntries(NAMES.map((name) => [name, colour(name)]));
}

/** A canvas's drawing context, with the canvas as fine as the screen; sizes are in CSS pixels. */
export function prepared(canvas) {
  const fine = Math.min(window.devicePixelRatio || 1, 2);
  const { clientWidth: width, clientHeight: height } = canvas;
  const [w, h] = [Math.round(width * fine), Math.round(height * fine)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context.setTransform(fine, 0, 0, fine, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/** Draw a polyline of points [x, y]; NaN interrupts it. */
export function stroke(context, points, { colour, width = 1, dash = [], alpha = 1 }) {
  context.beginPath();
  let down = false;
  for (const [x, y] of points) {
    const seen = !Number.isNaN(x + y);
    if (seen) context[down ? "lineTo" : "moveTo"](x, y);
    down = seen;
  }
  Object.assign(context, { strokeStyle: colour, lineWidth: width, globalAlpha: alpha });
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/** Fill a polygon, its edges in the same colour so that neighbours leave no gap. */
export function fill(context, points, colour) {
  context.beginPath();
  points.forEach((point) => context.lineTo(...point));
  context.closePath();
  Object.assign(context, { fillStyle: colour, strokeStyle: colour, lineWidth: 0.6 });
  context.fill();
  context.stroke();
}

/** Draw a disc, with a rim if that has a colour. */
export function dot(context, [x, y], radius, colour, { rim = null, width = 1.5, alpha = 1 } = {}) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  Object.assign(context, { fillStyle: colour, globalAlpha: alpha });
  context.fill();
  context.globalAlpha = 1;
  Object.assign(context, { strokeStyle: rim, lineWidth: width });
  if (rim) context.stroke();
}

/** Write a word. */
export function write(context, text, [x, y], colour, { size = 13, align = "center" } = {}) {
  context.font = `${size}px system-ui, "DejaVu Sans", sans-serif`;
  Object.assign(context, { fillStyle: colour, textAlign: align, textBaseline: "middle" });
  context.fillText(text, x, y);
}

/** The numbers from `from` to `until` in `count` equal steps, both ends included. */
export function even(from, until, count) {
  return [...Array(count + 1).keys()].map((i) => from + (until - from) * i / count);
}

/** A number as text, rounded to some significant digits. */
export function textOf(x, digits = 10) {
  return String(Number(x.toPrecision(digits))).replace("e+", "e").replace(/-/g, "−");
}

/** A rectangle of a canvas with scales: the places `x` and `y` of values in [x0, x1], [y0, y1]. */
export function chartOf(box, [x0, x1], [y0, y1]) {
  const { left, right, top, bottom } = box;
  return {
    ...box, x0, x1,
    x: (value) => left + (value - x0) / (x1 - x0) * (right - left),
    y: (value) => bottom - (value - y0) / (y1 - y0) * (bottom - top),
    valueAt: (place) => x0 + (place - left) / (right - left) * (x1 - x0),
  };
}

/** Write at most `most` numbers and, at `foot`, a name below a chart, with lines if `ruled`. */
export function drawNumbers(context, look, chart, name, most, ruled = false) {
  const { x, right, top, bottom, foot } = chart;
  for (const { at, text } of ticksBetween(chart.x0, chart.x1, most)) {
    const line = { colour: look.quiet, width: 0.6, alpha: 0.35 };
    if (ruled) stroke(context, [[x(at), top], [x(at), bottom]], line);
    write(context, text, [x(at), bottom + 10], look.ink, { size: 11 });
  }
  write(context, name, [right, foot], look.quiet, { size: 11, align: "right" });
}

/** At most `most` round numbers from `low` to `high`, as their values `at` and texts. */
export function ticksBetween(low, high, most) {
  const rough = (high - low) / Math.max(most, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((x) => x * power).find((x) => x >= rough * (1 - 1e-9));
  const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  const count = last - first < 100 ? last - first + 1 : 0;
  return [...Array(count).keys()].map((i) => (
    { at: (first + i) * step, text: tickText((first + i) * step, step) }));
}

/** A tick as text, with just enough digits to differ from its neighbours. */
export function tickText(x, step) {
  if (x === 0) return "0";
  const digits = Math.max(1, Math.ceil(Math.log10(Math.abs(x) / step)) + 1);
  const short = Number(x.toPrecision(Math.min(digits, 16)));
  const plain = Math.abs(short) < 1e6 && Math.abs(short) >= 1e-4;
  return (plain ? `${short}` : short.toExponential()).replace("e+", "e").replace("-", "−");
}
