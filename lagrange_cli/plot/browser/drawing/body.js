// The top: a cone on its tip, with six wedges that show the spin.

import { combined } from "./camera.js";
import { fill, stroke } from "./look.js";

const HEIGHT = 0.62;
export const LID = { height: HEIGHT, radius: 0.34 };
const WEDGES = 24;

/** A point of the lid's plane, at an angle from the line of nodes, counted like the spin. */
export function onLid({ nodes, across, axis }, angle, radius) {
  return combined(
    radius * Math.cos(angle), nodes, radius * Math.sin(angle), across, HEIGHT, axis);
}

/** Draw the cone; `blurred` where it turns too fast for its wedges to be seen. */
export function drawBody(context, view, look, frame, spin, blurred) {
  const angles = [...Array(WEDGES + 1).keys()].map((j) => spin + j * 2 * Math.PI / WEDGES);
  const rim = angles.map((angle) => view.project(onLid(frame, angle, LID.radius)));
  const sides = angles.slice(0, -1).map((angle) => (
    facesEye(view, frame, angle + Math.PI / WEDGES)));
  const parts = (apex, colour, seen) => {
    for (let sixth = 0; sixth < 6; sixth += 1) {
      const inks = [look.paper, colour];
      const ink = blurred ? mixed(...inks) : inks[sixth % 2];
      const corners = cornersOf(rim, sixth * WEDGES / 6, seen);
      if (corners.length) fill(context, [apex, ...corners], ink);
    }
  };
  parts(view.project([0, 0, 0]), look.red, sides);
  if (view.depth(frame.axis) > 0) {
    parts(view.project(onLid(frame, 0, 0)), look.blue, sides.map(() => true));
  }
  stroke(context, rim, { colour: look.ink, width: 0.9 });
}

/** The corners along the rim of the seen wedges of the sixth that begins at `first`. */
function cornersOf(rim, first, seen) {
  const wedges = [...Array(WEDGES / 6).keys()].map((j) => first + j).filter((j) => seen[j]);
  return wedges.length ? [rim[wedges[0]], ...wedges.map((j) => rim[j + 1])] : [];
}

/** Whether the side of the cone shows itself to the eye there. */
function facesEye(view, { nodes, across, axis }, angle) {
  const outward = combined(
    HEIGHT * Math.cos(angle), nodes, HEIGHT * Math.sin(angle), across, -LID.radius, axis);
  return view.depth(outward) > 0;
}

/** The colour midway between two, each #rrggbb. */
function mixed(first, second) {
  const parts = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  const [p, q] = [parts(first), parts(second)];
  return `rgb(${p.map((x, i) => Math.round((x + q[i]) / 2)).join(" ")})`;
}
