// The cubic f(u) = u'^2 (4,9), its roots, and the top as a point that runs between two of them.

import { dot, even, prepared, stroke, tickText, ticksBetween, write } from "./canvas.js";

const MARGIN = { left: 14, right: 14, top: 12, bottom: 32 };

/** f(u) from its product form; without torque it is a parabola. */
function cubicOf({ start, record, gaps }) {
  const lead = record.u3 === null ? null : +start.a;
  const parabola = gaps.aU3FromU1 ? -gaps.aU3FromU1 : 0;
  return (u) => (u - record.u1) * (u - record.u2) * (
    lead === null ? parabola : lead * (u - record.u3));
}

/** The range of u to show: the band of the motion, and u3 where it is near. */
function windowOf({ u1, u2, u3 }) {
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
  const { low, high, near } = windowOf(motion.record);
  const us = even(low, high, 240);
  const { u1, u2, u3 } = motion.record;
  const inside = us.filter((u) => u >= u2 && u <= (near ? u3 : u1)).map((u) => Math.abs(f(u)));
  const most = 1.35 * (Math.max(0, ...inside) || Math.max(...us.map((u) => Math.abs(f(u)))) || 1);
  const place = {
    x: (u) => MARGIN.left + (u - low) / (high - low) * (width - MARGIN.left - MARGIN.right),
    y: (v) => MARGIN.top + (most - v) / (2 * most) * (height - MARGIN.top - MARGIN.bottom),
  };
  drawField(context, look, place, { low, high, u1, u2, width, height });
  context.save();
  context.beginPath();
  context.rect(0, MARGIN.top, width, height - MARGIN.top - MARGIN.bottom);
  context.clip();
  stroke(context, us.map((u) => [place.x(u), place.y(f(u))]), { colour: look.blue, width: 1.8 });
  context.restore();
  drawRoots(context, look, place, motion.record, near, width);
  return (theta) => {
    const u = Math.min(Math.max(Math.cos(theta), u2), u1);
    return [place.x(u), place.y(Math.max(f(u), 0))];
  };
}

/** Draw the band of the motion, the axis f = 0 and the poles u = 1 and u = -1. */
function drawField(context, look, place, { low, high, u1, u2, width, height }) {
  const floor = height - MARGIN.bottom;
  context.fillStyle = look.faint;
  context.fillRect(place.x(u2), MARGIN.top, place.x(u1) - place.x(u2), floor - MARGIN.top);
  stroke(context, [[place.x(low), place.y(0)], [place.x(high), place.y(0)]], {
    colour: look.quiet,
  });
  for (const pole of [-1, 1].filter((u) => u >= low && u <= high)) {
    stroke(context, [[place.x(pole), MARGIN.top], [place.x(pole), floor]], {
      colour: look.quiet, dash: [4, 3],
    });
  }
  for (const { x, text } of ticksBetween(low, high, width / 70)) {
    write(context, text, [place.x(x), floor + 10], look.ink, { size: 11 });
  }
  write(context, "u = cos ϑ", [width - MARGIN.right, height - 8], look.quiet, {
    size: 11, align: "right",
  });
}

function drawRoots(context, look, place, { u1, u2, u3 }, near, width) {
  const double = u1 - u2 < 1e-12;
  const roots = double
    ? [["u₁ = u₂", u1, 0, 14]] : [["u₂", u2, -13, -11], ["u₁", u1, 13, -11]];
  if (near) roots.push(["u₃", u3, 13, 13]);
  else if (u3 !== null) {
    write(context, `u₃ = ${tickText(u3, 1e-4 * Math.abs(u3))} →`,
      [width - MARGIN.right, MARGIN.top + 8], look.ink, { size: 12, align: "right" });
  }
  for (const [name, u, right, down] of roots) {
    dot(context, [place.x(u), place.y(0)], 4, look.ink);
    write(context, name, [place.x(u) + right, place.y(0) + down], look.ink, { size: 13 });
  }
}
