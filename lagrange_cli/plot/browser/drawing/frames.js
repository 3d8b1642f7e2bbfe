// The frames in space and in the body, and the angles between them.

import { combined } from "./camera.js";
import { LID, onLid } from "./body.js";
import { fill, stroke, write } from "./look.js";

const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const LENGTH = 1.2;

/** Draw the axes in space that point away from the eye, or those that point towards it. */
export function drawAxes(context, view, look, near) {
  for (const [name, axis] of Object.entries(AXES)) {
    if ((view.depth(axis) >= 0) === near) {
      arrow(context, view, [0, 0, 0], scaled(axis, LENGTH), look.quiet, near ? 1.2 : 0.8);
      write(context, name, view.project(scaled(axis, LENGTH + 0.07)), look.quiet);
    }
  }
}

/** Draw the axes in the body: the figure axis out to the sphere, x' and y' on the lid. */
export function drawBodyAxes(context, view, look, frame, spin) {
  const middle = onLid(frame, 0, 0);
  stroke(context, [middle, frame.axis].map(view.project), { colour: look.ink, width: 1.6 });
  for (const [name, angle] of [["x′", spin], ["y′", spin + Math.PI / 2]]) {
    arrow(context, view, middle, onLid(frame, angle, 0.45), look.ink, 1.1);
    write(context, name, view.project(onLid(frame, angle, 0.53)), look.ink, { size: 12 });
  }
}

/** Draw the line of nodes and the three angles, each in the colour of its curve. */
export function drawAngles(context, view, look, frame, { theta, spin, psi, vertical }) {
  const { nodes, axis } = frame;
  if (!vertical) {
    const ends = [scaled(nodes, -0.25), scaled(nodes, 1)].map(view.project);
    stroke(context, ends, { colour: look.green, width: 1, dash: [6, 3] });
    const across = combined(1 / Math.sin(theta), axis, -1 / Math.tan(theta), AXES.z);
    arc(context, view, look.green, "ψ", psi, (x) => [0.55 * Math.cos(x), 0.55 * Math.sin(x), 0]);
    arc(context, view, look.blue, "ϑ", theta, (x) => (
      combined(0.8 * Math.cos(x), AXES.z, 0.8 * Math.sin(x), across)));
  }
  const middle = onLid(frame, 0, 0);
  stroke(context, [middle, onLid(frame, 0, 0.42)].map(view.project), {
    colour: look.green, width: 1, dash: [4, 3],
  });
  arc(context, view, look.red, "φ", spin, (x) => onLid(frame, x, LID.radius * 1.14));
}

/** Draw an arc from 0 to an angle, with its name in the middle. */
function arc(context, view, colour, name, angle, point) {
  const steps = 32;
  const points = [...Array(steps + 1).keys()].map((i) => point(angle * i / steps));
  stroke(context, points.map(view.project), { colour, width: 2 });
  if (Math.abs(angle) > 0.12) {
    const [x, y] = view.project(points[steps / 2]);
    const [cx, cy] = view.project([0, 0, 0]);
    const away = 12 / Math.max(Math.hypot(x - cx, y - cy), 1);
    write(context, name, [x + (x - cx) * away, y + (y - cy) * away], colour, { size: 16 });
  }
}

function arrow(context, view, from, to, colour, width) {
  const [[x0, y0], [x1, y1]] = [view.project(from), view.project(to)];
  stroke(context, [[x0, y0], [x1, y1]], { colour, width });
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (length < 12) return;
  const [dx, dy] = [(x1 - x0) / length * 7, (y1 - y0) / length * 7];
  const corners = [1, -1].map((side) => [x1 - dx - side * dy * 0.4, y1 - dy + side * dx * 0.4]);
  fill(context, [[x1, y1], ...corners], colour);
}

function scaled(p, factor) {
  return p.map((x) => factor * x);
}
