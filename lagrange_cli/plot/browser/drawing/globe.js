// The unit sphere: outline, equator, the limiting circles of the tilt and the trace of the axis.

import { stroke } from "./look.js";

const AROUND = [...Array(361).keys()].map((i) => i * Math.PI / 180);

/** The circle of a tilt on the unit sphere. */
function parallel(tilt) {
  const [sine, cosine] = [Math.sin(tilt), Math.cos(tilt)];
  return AROUND.map((psi) => [sine * Math.cos(psi), sine * Math.sin(psi), cosine]);
}

/** Draw the disc of the globe. */
export function drawDisc(context, view, look) {
  const [x, y] = view.project([0, 0, 0]);
  context.beginPath();
  context.arc(x, y, view.scale, 0, 2 * Math.PI);
  context.globalAlpha = 0.55;
  context.fillStyle = look.faint;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = look.quiet;
  context.lineWidth = 1;
  context.stroke();
}

/** Draw the part of a curve on one side of the sphere. */
function drawSide(context, view, points, near, style) {
  const seen = points.map((p) => ((view.depth(p) >= 0) === near ? view.project(p) : [NaN, NaN]));
  stroke(context, seen, style);
}

/** Draw equator and limiting circles on the near side or, pale and dashed, on the far side. */
export function drawCircles(context, view, look, { theta_min_deg, theta_max_deg }, near) {
  const circles = [
    [90, { colour: look.quiet, width: 0.6 }],
    [theta_min_deg, { colour: look.blue, width: 1.1 }],
    [theta_max_deg, { colour: look.red, width: 1.1 }],
  ];
  const faded = near ? {} : { alpha: 0.4, dash: [3, 3] };
  for (const [tilt, style] of circles) {
    drawSide(context, view, parallel(tilt * Math.PI / 180), near, { ...style, ...faded });
  }
}

/** Draw one side of the trace: the past strong, the future faint. */
export function drawTrace(context, view, look, { axes, times }, t, near) {
  const here = times.findIndex((time) => time > t);
  const end = here < 0 ? times.length : here;
  const [width, alpha] = near ? [2.2, 1] : [1.2, 0.4];
  const side = (points, style) => drawSide(context, view, points, near, style);
  side(axes.slice(Math.max(end - 1, 0)), { colour: look.trace, width: 1, alpha: 0.35 * alpha });
  side(axes.slice(0, end), { colour: look.trace, width, alpha });
}
