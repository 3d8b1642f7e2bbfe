// The motion in words.

/** A title and one or two sentences on what is to be seen. */
export function wordsOf(motion) {
  const { facts, record, start } = motion;
  const lambda = `λ = b²/2a = ${shortly(start.b * start.b / (2 * start.a))}`;
  switch (record.regime) {
    case "sleeping": return facts.stable
      ? ["Sleeping, stable", `The top stands upright and stays: ${lambda} is at least 1.`]
      : ["Sleeping, unstable",
        `The top stands upright, but any push fells it: ${lambda} is less than 1.`];
    case "hanging":
      return ["Hanging", "The axis hangs straight down and turns about itself, whatever the spin."];
    case "torque-free":
      return ["Without torque", facts.steady
        ? "Nothing pulls at the top: its axis stands still, or goes round evenly."
        : "Nothing pulls at the top: its axis goes round a tilted circle at a constant rate."];
    case "separatrix":
      return ["Separatrix",
        "The axis rises to the vertical, slower and slower, and never arrives."];
    case "steady precession":
      return ["Steady precession", "The tilt does not change, and the axis goes round evenly."];
    case "no spin": return pendulum(facts);
    default: return regular(motion, lambda);
  }
}

function pendulum(facts) {
  return facts.overBottom
    ? ["Plane pendulum", "Without spin the top is a pendulum, here one that swings in a plane."]
    : ["Spherical pendulum", "Without spin the top is a pendulum, here one that goes round."];
}

function regular({ facts, record, start }, lambda) {
  if (facts.atRest && start.b * start.b >= 50 * start.a) {
    const nod = shortly(record.theta_max_deg - record.theta_min_deg);
    return ["Pseudo-regular precession",
      `Let go at rest, and so fast that it nods by ${nod}° only. ${lambda}.`];
  }
  const paths = {
    cusped: ["Regular motion with cusps",
      "At the top of every nod the axis stands still for a moment, and falls again: cusps."],
    looping: ["Regular motion with loops",
      "Near the top of every nod the precession runs backwards: the axis draws loops."],
    wavy: ["Regular motion in waves",
      "The precession never turns back: the axis draws waves."],
  };
  const [title, text] = paths[record.path] ?? paths.wavy;
  return [title, `${text} ${lambda}.`];
}

/** A number in a few digits, for a sentence. */
export function shortly(x, digits = 3) {
  return x.toPrecision(digits).replace(/\.?0+(e|$)/, "$1").replace("e+", "e").replace("-", "−");
}
