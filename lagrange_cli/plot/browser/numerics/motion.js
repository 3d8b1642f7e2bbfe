// The motion of one top: periods, tilts and mean rates.  Equation numbers are those of the paper.

import { completeK, pair, periodMean, PI } from "./arithmetic.js";
import { constantSampler, nutatingSampler, offsetOf, separatrixSampler } from "./attitude.js";
import { checkRoots, checkScene, factsOf, gapsOf, startOf } from "./start.js";

/** A number over the parts that cancel in it is shown from here on: ten digits must be right. */
const LEAST = 1e-20;

/** The motion of a scene: its record, and `angles(t)`.  Raises RangeError for a bad input. */
export function motionOf(scene) {
  checkScene(scene);
  const start = startOf(scene);
  const facts = factsOf(start);
  const gaps = gapsOf(start, facts);
  checkRoots(facts, gaps);
  const motion = { scene, start, facts, gaps, ...moduliOf(start, facts, gaps) };
  Object.assign(motion, ratesOf(motion));
  motion.record = recordOf(motion);
  const constant = facts.vertical || facts.steady;
  const moving = facts.separatrix ? separatrixSampler : nutatingSampler;
  motion.angles = (constant ? constantSampler : moving)(motion);
  if (!Object.values(motion.angles(motion.period ?? 1)).every(Number.isFinite)) {
    throw new RangeError("its numbers leave the range of the page: ask lagtop solve");
  }
  return motion;
}

/** Moduli (4,19), (4,21), quarter periods and the period of the nutation (5,1). */
function moduliOf(start, facts, gaps) {
  if (facts.vertical) return {};
  const argumentRate = gaps.aU3FromU2.sqrt().over(2);  // dw/dt (4,30)
  const m = facts.steady ? pair(0) : start.a.times(gaps.band).over(gaps.aU3FromU2);
  const kPrime = facts.steady ? pair(1) : gaps.aU3FromU1.over(gaps.aU3FromU2).sqrt();
  const k = m.sqrt();
  if (facts.separatrix) return { argumentRate, m, k, kPrime, KPrime: completeK(1) };
  const K = completeK(kPrime);
  const offset = facts.steady ? null : offsetOf(start, gaps, kPrime, K);
  return {
    argumentRate, m, k, kPrime, K, offset,
    KPrime: +k > 0 ? completeK(k) : null,
    period: argumentRate > 0 ? K.times(2).over(argumentRate) : null,
  };
}

/** Mean rates of spin (6,3) and precession (7,3); those of a constant tilt. */
function ratesOf({ start, facts, gaps, kPrime, period }) {
  if (facts.vertical) return { spinRate: start.r0, precessionRate: pair(0) };
  if (facts.steady) {
    const spinRate = start.r0.minus(start.psiRate.times(start.cos));  // (4,8)
    return { spinRate, precessionRate: start.psiRate, spinSize: Math.abs(start.r0) };
  }
  if (facts.separatrix) return {};
  // south and north are the means of (beta - b u)/(2 (1 + u)) and (beta - b u)/(2 (1 - u)): the
  // precession rate is their sum (4,7), the spin rate r0 + south - north (4,8)
  const { belowU1, belowU2, aboveU1, aboveU2, momentumU1, momentumU2 } = gaps;
  const mean = (fromU1, fromU2, atU1, atU2) => {
    const mc = kPrime.squared();
    const p = fromU2.times(mc).over(fromU1);
    return periodMean(kPrime, p, atU1, atU2.times(mc)).over(fromU1).over(2);
  };
  const overTop = facts.upperRoot === 1;
  if (!facts.free && !overTop && !facts.overBottom) {
    const momenta = [momentumU1, momentumU2];
    const [south, north, southSize, northSize] = [momenta, momenta.map((x) => x.size())].flatMap(
      (ends) => [mean(belowU1, belowU2, ...ends), mean(aboveU1, aboveU2, ...ends)]);
    return rates(start.r0, south, north, southSize + northSize);
  }
  // apart, (beta + b)/(2 (1 + u)) and (beta - b)/(2 (1 - u)): each makes half a turn per period
  // without torque, and over its pole
  const poleRate = (pole, sign, fromU1, fromU2, beta) => (
    facts.free || pole ? PI.over(period).times(sign) : mean(fromU1, fromU2, beta, beta));
  const south = poleRate(facts.overBottom, facts.signPlus, belowU1, belowU2, gaps.betaPlusB);
  const north = poleRate(overTop, facts.signMinus, aboveU1, aboveU2, gaps.betaMinusB);
  return rates(start.poleDrift, south, north);
}

/** Mean rates, and the sizes of the parts that cancel in them. */
function rates(spin, south, north, precessionSize = Math.abs(south) + Math.abs(north)) {
  return {
    spinRate: spin.plus(south).minus(north),
    precessionRate: south.plus(north),
    spinSize: Math.abs(spin) + precessionSize,
    precessionSize,
  };
}

/** Path of the figure axis, by where the precession stands still: at u1, within, or nowhere. */
function pathOf({ facts, gaps, start }) {
  if (facts.vertical || facts.steady) return null;
  if (facts.cusp || (facts.atRest && facts.spins)) return "cusped";
  if (facts.plane) return null;
  const loops = start.b * gaps.momentumU1 < 0 && start.b * gaps.momentumU2 > 0;
  return loops ? "looping" : "wavy";
}

function degreesOf(above, below) {
  return 2 * Math.atan2(Math.sqrt(above), Math.sqrt(below)) * 180 / Math.PI;
}

/** The numbers of the scene as doubles, by key; null if undefined, NaN if digits are lost. */
function recordOf(motion) {
  const { start, facts, gaps } = motion;
  const number = (x) => (x === undefined || x === null ? null : +x);
  const vanish = facts.vertical || facts.free || !(facts.spins || +start.psiRate);  // exactly 0
  const known = (x, size, zero) => ((+x ? Math.abs(x) > LEAST * size : zero) ? +x : NaN);
  const rate = (x, size) => (x === undefined ? null : known(x, size ?? 0, vanish));
  const spinRate = rate(motion.spinRate, motion.spinSize);
  const precessionRate = facts.vertical ? null : rate(motion.precessionRate, motion.precessionSize);
  const turn = (x) => (x === null || x === 0 ? null : 2 * Math.PI / Math.abs(x));
  const root = (u, gap) => known(u, 1, !(+gap || +start.cos));
  const u2 = +gaps.aboveU2 < +gaps.belowU2
    ? pair(1).minus(gaps.aboveU2) : gaps.belowU2.minus(1);
  const nome = motion.K && motion.KPrime ? Math.exp(-Math.PI * motion.KPrime / motion.K) : null;
  return {
    regime: facts.regime,
    a: +start.a,
    b: +start.b,
    stability_factor: facts.free ? null : start.b * start.b / (2 * start.a),
    u1: root(start.cos.plus(gaps.u1FromStart), gaps.u1FromStart),
    u2: root(u2, gaps.startFromU2),
    u3: facts.free || facts.vertical ? null : +gaps.aU3Above.over(start.a).plus(1),
    k: number(motion.k),
    k_prime: number(motion.kPrime),
    nome: facts.vertical ? null : facts.separatrix ? 1 : nome ?? 0,
    K: number(motion.K),
    K_prime: number(motion.KPrime),
    T_nutation: number(motion.period),
    T_spin: turn(spinRate),
    T_precession: turn(precessionRate),
    theta_min_deg: degreesOf(gaps.aboveU1, gaps.belowU1),
    theta_max_deg: degreesOf(gaps.aboveU2, gaps.belowU2),
    mean_spin_rate: spinRate,
    mean_precession_rate: precessionRate,
    path: pathOf(motion),
  };
}
