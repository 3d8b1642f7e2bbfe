// The spinning top in space, from back to front.

import { drawAngles, drawAxes, drawBodyAxes } from "./frames.js";
import { drawBody } from "./body.js";
import { drawCircles, drawDisc, drawTrace } from "./globe.js";
import { dot, prepared } from "./look.js";
import { frameOf } from "./camera.js";

/** Draw the top at one time; `shown` says which parts. */
export function drawSpace(canvas, camera, look, { motion, curves, t, angles, blurred, shown }) {
  const { context, width, height } = prepared(canvas);
  const posture = { theta: angles.theta, psi: angles.psiWithin };
  const frame = frameOf(posture);
  const spin = angles.phiWithin;
  const view = camera.view(width, height, centreOf(motion, t, camera.zoom));
  const side = (near) => {
    if (shown.circles) drawCircles(context, view, look, motion.record, near);
    if (shown.trace) drawTrace(context, view, look, curves, t, near);
    if (shown.axes) drawAxes(context, view, look, near);
  };
  const axle = () => {
    if (shown.axes) drawBodyAxes(context, view, look, frame, spin);
  };
  drawDisc(context, view, look);
  side(false);
  const away = view.depth(frame.axis) < 0;
  if (away) axle();
  drawBody(context, view, look, frame, spin, blurred);
  if (!away) axle();
  side(true);
  if (shown.angles) {
    const vertical = Math.sin(angles.theta) < 1e-9;
    drawAngles(context, view, look, frame, { ...posture, spin, vertical });
  }
  dot(context, view.project(frame.axis), 4, look.trace, look.paper);
}

/** What is in the middle: the pivot, or from near by the mean place of the axis, which glides. */
function centreOf({ record }, t, zoom) {
  const theta = (record.theta_min_deg + record.theta_max_deg) / 2 * Math.PI / 180;
  const psi = (record.mean_precession_rate ?? 0) * t % (2 * Math.PI);
  const part = Math.min(Math.max(zoom - 1.5, 0), 1);
  return frameOf({ theta, psi }).axis.map((x) => part * x);
}
