// The cubic f(u) = u'^2 (4,9), its roots, and the top as a point that runs between two of them.

import { chartOf, dot, drawNumbers, even, prepared, stroke, tickText, write } from "./canvas.js";

/** f(u) from its product form; without torque it is a parabola. */
function cubicOf({ start, record, gaps }) {
  const lead = record.u3 === null ? null : +start.a;
  const parabola = gaps.aU3FromU1 ? -gaps.aU3FromU1 : 0;
  return (u) => (u - record.u1) * (u - record.u2) * (
    lead === null ? parabola : lead * (u - record.u3));
}

/** The range of u to show: the band of the motion, and u3 where it is near. */
function shownRange({ u1, u2, u3 }) {
  const band = u1 - u2;
  const near = u3 !== null && u3 - u1 <= Math.max(4 * band, band ? 0 : 2);
  const width = (near ? u3 : u1) - u2 || 0.4;
  return { low: u2 - 0.5 * width, high: u2 + 1.5 * width, near };
}

/** Draw the cubic; returns where the top is on it at a tilt, if it is on it at all. */
export function drawCubic(canvas, look, motion) {
  const { context, width, height } = prepared(canvas);
  if (motion.facts.vertical) {
    const why = "the axis is vertical: the tilt does not change";
    write(context, why, [width / 2, height / 2], look.quiet);
    return () => null;
  }
  const f = cubicOf(motion);
  const { low, high, near } = shownRange(motion.record);
  const us = even(low, high, 240);
  const { u1, u2, u3 } = motion.record;
  const inside = us.filter((u) => u >= u2 && u <= (near ? u3 : u1)).map((u) => Math.abs(f(u)));
  const most = 1.35 * (Math.max(0, ...inside) || Math.max(...us.map((u) => Math.abs(f(u)))) || 1);
  const box = { left: 14, right: width - 14, top: 12, bottom: height - 32, foot: height - 8 };
  const chart = chartOf(box, [low, high], [-most, most]);
  drawField(context, look, chart, motion.record);
  drawNumbers(context, look, chart, "u = cos ϑ", width / 70);
  context.save();
  context.beginPath();
  context.rect(0, box.top, width, box.bottom - box.top);
  context.clip();
  stroke(context, us.map((u) => [chart.x(u), chart.y(f(u))]), { colour: look.blue, width: 1.8 });
  context.restore();
  drawRoots(context, look, chart, motion.record, near);
  return (theta) => {
    const u = Math.min(Math.max(Math.cos(theta), u2), u1);
    return [chart.x(u), chart.y(Math.max(f(u), 0))];
  };
}

/** Draw the band of the motion, the axis f = 0 and the poles u = 1 and u = -1. */
function drawField(context, look, { x, y, x0, x1, left, right, top, bottom }, { u1, u2 }) {
  context.fillStyle = look.faint;
  context.fillRect(x(u2), top, x(u1) - x(u2), bottom - top);
  stroke(context, [[left, y(0)], [right, y(0)]], { colour: look.quiet });
  for (const pole of [-1, 1].filter((u) => u >= x0 && u <= x1)) {
    stroke(context, [[x(pole), top], [x(pole), bottom]], { colour: look.quiet, dash: [4, 3] });
  }
}

/** Draw the roots with their names; u3 may be out of sight on the right. */
function drawRoots(context, look, { x, y, right, top }, { u1, u2, u3 }, near) {
  const double = u1 - u2 < 1e-12;
  const roots = double
    ? [["u₁ = u₂", u1, 0, 14]] : [["u₂", u2, -13, -11], ["u₁", u1, 13, -11]];
  if (near) roots.push(["u₃", u3, 13, 13]);
  else if (u3 !== null) {
    const far = `u₃ = ${tickText(u3, 1e-4 * Math.abs(u3))} →`;
    write(context, far, [right, top + 8], look.ink, { size: 12, align: "right" });
  }
  for (const [name, u, across, down] of roots) {
    dot(context, [x(u), y(0)], 4, look.ink);
    write(context, name, [x(u) + across, y(0) + down], look.ink, { size: 13 });
  }
}
