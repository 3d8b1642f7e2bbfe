// The spinning top in space, from back to front: the globe with the limiting circles of the tilt
// and the trace of the axis, the frames and their angles, and the top, a cone whose six wedges show
// the spin.

import { CONE } from "../data.js";
import { dot, even, fill, prepared, stroke, write } from "./canvas.js";

const { height: HEIGHT, radius: RADIUS, wedges: WEDGES } = CONE;
const SIXTH = WEDGES / 6;  // of the same colour
const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const LENGTH = 1.2;  // of the axes in space
const CIRCLE = even(0, 2 * Math.PI, 360);

/** Draw the top at one time; `shown` says which parts. */
export function drawSpace(canvas, camera, look, { motion, curves, t, angles, blurred, shown }) {
  const { context, width, height } = prepared(canvas);
  const { theta, psiWithin: psi, phiWithin: spin } = angles;
  const frame = frameOf({ theta, psi });
  const view = camera.view(width, height, centreOf(motion, t, camera.zoom));
  const side = (near) => {
    if (shown.circles) drawCircles(context, view, look, motion.record, near);
    if (shown.trace) drawTrace(context, view, look, curves, t, near);
    if (shown.axes) drawAxes(context, view, look, near);
  };
  const axle = () => {
    if (shown.axes) drawBodyAxes(context, view, look, frame, spin);
  };
  const pivot = view.project([0, 0, 0]);
  dot(context, pivot, view.scale, look.faint, { rim: look.quiet, width: 1, alpha: 0.55 });
  side(false);
  const away = view.depth(frame.axis) < 0;
  if (away) axle();
  drawBody(context, view, look, frame, spin, blurred);
  if (!away) axle();
  side(true);
  if (shown.angles) drawAngles(context, view, look, frame, { theta, psi, spin });
  dot(context, view.project(frame.axis), 4, look.trace, { rim: look.paper });
}

/** The centre of the picture: the pivot, or from near by the mean place of the axis. */
function centreOf({ record }, t, zoom) {
  const theta = (record.theta_min_deg + record.theta_max_deg) / 2 * Math.PI / 180;
  const psi = (record.mean_precession_rate ?? 0) * t % (2 * Math.PI);
  return scaled(frameOf({ theta, psi }).axis, Math.min(Math.max(zoom - 1.5, 0), 1));
}

/** Draw the part of a curve on one side of the sphere. */
function drawSide(context, view, points, near, style) {
  const seen = points.map((p) => ((view.depth(p) >= 0) === near ? view.project(p) : [NaN, NaN]));
  stroke(context, seen, style);
}

/** Draw equator and limiting circles on the near side or, pale and dashed, on the far side. */
function drawCircles(context, view, look, { theta_min_deg, theta_max_deg }, near) {
  const circles = [
    [90, { colour: look.quiet, width: 0.6 }],
    [theta_min_deg, { colour: look.blue, width: 1.1 }],
    [theta_max_deg, { colour: look.blue, width: 1.1, dash: [9, 3, 2, 3] }],
  ];
  const faded = near ? {} : { alpha: 0.4, dash: [3, 3] };
  for (const [tilt, style] of circles) {
    const circle = CIRCLE.map((psi) => frameOf({ theta: tilt * Math.PI / 180, psi }).axis);
    drawSide(context, view, circle, near, { ...style, ...faded });
  }
}

/** Draw one side of the trace: the past strong, the future faint. */
function drawTrace(context, view, look, { axes, times }, t, near) {
  const here = times.findIndex((time) => time > t);
  const end = here < 0 ? times.length : here;
  const [width, alpha] = near ? [2.2, 1] : [1.2, 0.4];
  const side = (points, style) => drawSide(context, view, points, near, style);
  side(axes.slice(Math.max(end - 1, 0)), { colour: look.trace, width: 1, alpha: 0.35 * alpha });
  side(axes.slice(0, end), { colour: look.trace, width, alpha });
}

/** Draw the axes in space that point away from the eye, or those that point towards it. */
function drawAxes(context, view, look, near) {
  for (const [name, axis] of Object.entries(AXES)) {
    if ((view.depth(axis) >= 0) === near) {
      arrow(context, view, [0, 0, 0], scaled(axis, LENGTH), look.quiet, near ? 1.2 : 0.8);
      write(context, name, view.project(scaled(axis, LENGTH + 0.07)), look.quiet);
    }
  }
}

/** A point of the body at an angle from the line of nodes, on the lid or at another height. */
export function onLid({ nodes, across, axis }, angle, radius, height = HEIGHT) {
  return combined(
    radius * Math.cos(angle), nodes, radius * Math.sin(angle), across, height, axis);
}

/** Draw the cone; `blurred` if it turns too fast for its wedges to be seen. */
function drawBody(context, view, look, frame, spin, blurred) {
  const angles = even(spin, spin + 2 * Math.PI, WEDGES);
  const rim = angles.map((angle) => view.project(onLid(frame, angle, RADIUS)));
  const facesEye = angles.slice(0, -1).map((angle) => (
    view.depth(onLid(frame, angle + Math.PI / WEDGES, HEIGHT, -RADIUS)) > 0));
  const drawSixths = (apex, colour, seen) => {
    for (let first = 0; first < WEDGES; first += SIXTH) {
      const wedges = even(first, first + SIXTH - 1, SIXTH - 1).filter((j) => seen[j]);
      const ink = first / SIXTH % 2 ? colour : look.paper;
      const corners = [apex, rim[wedges[0]], ...wedges.map((j) => rim[j + 1])];
      if (wedges.length) fill(context, corners, blurred ? mixed(look.paper, colour) : ink);
    }
  };
  drawSixths(view.project([0, 0, 0]), look.red, facesEye);
  if (view.depth(frame.axis) > 0) {
    drawSixths(view.project(onLid(frame, 0, 0)), look.blue, facesEye.map(() => true));
  }
  stroke(context, rim, { colour: look.ink, width: 0.9 });
}

/** The colour midway between two, each #rrggbb. */
function mixed(first, second) {
  const parts = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  const [p, q] = [parts(first), parts(second)];
  return `rgb(${p.map((x, i) => Math.round((x + q[i]) / 2)).join(" ")})`;
}

/** Draw the axes in the body: the figure axis out to the sphere, x' and y' on the lid. */
function drawBodyAxes(context, view, look, frame, spin) {
  const middle = onLid(frame, 0, 0);
  stroke(context, [middle, frame.axis].map(view.project), { colour: look.ink, width: 1.6 });
  for (const [name, angle] of [["x′", spin], ["y′", spin + Math.PI / 2]]) {
    arrow(context, view, middle, onLid(frame, angle, 0.45), look.ink, 1.1);
    write(context, name, view.project(onLid(frame, angle, 0.53)), look.ink, { size: 12 });
  }
}

/** Draw the line of nodes and the three angles, each in the colour of its curve. */
function drawAngles(context, view, look, frame, { theta, spin, psi }) {
  const { nodes, axis } = frame;
  if (Math.sin(theta) >= 1e-9) {
    const ends = [scaled(nodes, -0.25), nodes].map(view.project);
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
  arc(context, view, look.red, "φ", spin, (x) => onLid(frame, x, RADIUS * 1.14));
}

/** Draw an arc from 0 to an angle, with its name in the middle. */
function arc(context, view, colour, name, angle, point) {
  const points = even(0, angle, 32).map((x) => view.project(point(x)));
  stroke(context, points, { colour, width: 2 });
  if (Math.abs(angle) > 0.12) {
    const [[x, y], [cx, cy]] = [points[16], view.project([0, 0, 0])];
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

// The camera, an orthographic view of the unit sphere, and the vectors of a body.

export class Camera {
  constructor() {
    this.reset();
  }

  /** Look from where a top that starts to the front is seen best. */
  reset() {
    this.azimuth = -62;  // degrees; the axis starts towards -90
    this.elevation = 20;
    this.zoom = 1;
  }

  /** Turn by some degrees; the eye never passes over a pole. */
  turn(right, up) {
    this.azimuth = (this.azimuth - right) % 360;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + up));
  }

  magnify(factor) {
    this.zoom = Math.max(0.5, Math.min(400, this.zoom * factor));
  }

  /** The view on a canvas of this size; `centre` is the point of space in its middle. */
  view(width, height, centre = [0, 0, 0]) {
    const [azimuth, elevation] = [this.azimuth, this.elevation].map((x) => x * Math.PI / 180);
    const [sa, ca] = [Math.sin(azimuth), Math.cos(azimuth)];
    const [se, ce] = [Math.sin(elevation), Math.cos(elevation)];
    const right = [-sa, ca, 0];
    const up = [-se * ca, -se * sa, ce];
    const toward = [ce * ca, ce * sa, se];
    const scale = this.zoom * Math.min(width, height) / 2.6;
    const [x0, y0] = [dot3(centre, right), dot3(centre, up)];
    return {
      scale,
      project: (p) => [
        width / 2 + scale * (dot3(p, right) - x0),
        height * 0.515 - scale * (dot3(p, up) - y0),
      ],
      depth: (p) => dot3(p, toward),
    };
  }
}

function dot3(p, q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

/** x p + y q + z r */
function combined(x, p, y, q, z = 0, r = p) {
  return [0, 1, 2].map((i) => x * p[i] + y * q[i] + z * r[i]);
}

/** The frame of a body at its Euler angles: line of nodes, figure axis, and across both. */
export function frameOf({ theta, psi }) {
  const [st, ct] = [Math.sin(theta), Math.cos(theta)];
  const [sp, cp] = [Math.sin(psi), Math.cos(psi)];
  return { nodes: [cp, sp, 0], axis: [st * sp, -st * cp, ct], across: [-ct * sp, ct * cp, st] };
}

/** A vector times a number. */
function scaled(p, factor) {
  return p.map((x) => factor * x);
}
