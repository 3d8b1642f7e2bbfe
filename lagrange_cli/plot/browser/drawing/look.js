// Colours and letters, from the style sheet of the page.

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
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
  }
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
    if (Number.isNaN(x) || Number.isNaN(y)) down = false;
    else if (down) context.lineTo(x, y);
    else {
      context.moveTo(x, y);
      down = true;
    }
  }
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.globalAlpha = alpha;
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/** Fill a polygon, its edges in the same colour so that neighbours leave no gap. */
export function fill(context, points, colour) {
  context.beginPath();
  points.forEach((point) => context.lineTo(...point));
  context.closePath();
  context.fillStyle = colour;
  context.fill();
  context.strokeStyle = colour;
  context.lineWidth = 0.6;
  context.stroke();
}

/** Draw a disc with a rim. */
export function dot(context, [x, y], radius, fill, rim) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  if (rim) {
    context.strokeStyle = rim;
    context.lineWidth = 1.5;
    context.stroke();
  }
}

/** Write a word, with a `halo` in the colour of the paper where curves pass. */
export function write(context, text, [x, y], colour, { size = 13, align = "center", halo } = {}) {
  context.font = `${size}px system-ui, "DejaVu Sans", sans-serif`;
  context.fillStyle = colour;
  context.textAlign = align;
  context.textBaseline = "middle";
  if (halo) {
    context.strokeStyle = halo;
    context.lineWidth = 4;
    context.strokeText(text, x, y);
  }
  context.fillText(text, x, y);
}
