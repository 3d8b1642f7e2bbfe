// The time: play, pause, speed, step, and any time at once.  The motion is in closed form, so that
// no time is farther than another.

import { textOf } from "../drawing/canvas.js";
import { numberOf } from "./inputs.js";

const FARTHEST = 1e15;

export class Clock {
  /** `changed()` is called when the time is set by hand. */
  constructor(page, changed) {
    this.page = page;
    this.changed = changed;
    this.t = 0;
    this.playing = false;
    this.period = 1;
    this.usual = 1;
    page.play.addEventListener("click", () => this.play(!this.playing));
    page.restart.addEventListener("click", () => this.set(0));
    page.back.addEventListener("click", (event) => this.step(-1, event.shiftKey));
    page.forward.addEventListener("click", (event) => this.step(1, event.shiftKey));
    page.scrub.addEventListener("input", () => this.set(Number(page.scrub.value)));
    page.time.addEventListener("change", () => this.setText(page.time.value));
    page.speed.addEventListener("input", () => this.showSpeed());
  }

  /** Scene time per second of the clock on the wall. */
  get speed() {
    return this.usual * 10 ** Number(this.page.speed.value);
  }

  /** Adapt to the period of a scene; `anew` also sets the usual speed. */
  adapt(period, anew) {
    this.period = period;
    if (!this.reaches(this.t)) this.t = 0;
    if (anew) this.usual = nice(period / 2.5);
    this.page.scrub.max = String(100 * period);
    this.page.scrub.step = String(period / 1000);
    this.showSpeed();
    this.show();
  }

  play(on) {
    this.playing = on;
    this.page.play.textContent = on ? "❚❚ Pause" : "▶ Play";
    this.page.play.setAttribute("aria-pressed", String(on));
    this.changed();
  }

  /** Go by a fiftieth of a period, or by a whole one. */
  step(direction, whole) {
    this.play(false);
    this.set(this.t + direction * this.period / (whole ? 1 : 50));
  }

  /** Whether a time is near enough for the angles to mean anything. */
  reaches(t) {
    return Math.abs(t) <= FARTHEST * this.period;
  }

  setText(text) {
    const t = numberOf(text);
    const fine = this.reaches(t);
    this.page.time.setAttribute("aria-invalid", String(!fine));
    if (fine) this.set(t);
  }

  set(t) {
    this.t = t;
    this.show();
    this.changed();
  }

  /** Let a part of a second pass. */
  pass(seconds) {
    if (!this.playing) return false;
    this.t += this.speed * seconds;
    this.show();
    return true;
  }

  show() {
    const { time, scrub } = this.page;
    const shown = this.t === 0 ? "0" : textOf(this.t, 7);
    if (document.activeElement !== time) time.value = shown;
    scrub.value = String(this.t);
    scrub.setAttribute("aria-valuetext", `t = ${shown}`);
  }

  showSpeed() {
    const text = `${textOf(this.speed, 2)} t/s`;
    this.page.speedShown.textContent = text;
    this.page.speed.setAttribute("aria-valuetext", text);
  }
}

/** The nearest of 1, 2, 5, 10, 20 ... */
function nice(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  const lead = x / power;
  return (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
}
