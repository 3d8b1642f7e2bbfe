// The page: one scene, its motion, and all that shows it.

import { EXAMPLES, INPUTS, SCENE, UNITS } from "../data.js";
import { readLook, textOf } from "../drawing/canvas.js";
import { curvesAt, drawCubic, drawPlots, windowOf } from "../drawing/plots.js";
import { Camera, drawSpace, frameOf, onLid } from "../drawing/space.js";
import { motionOf } from "../numerics/motion.js";
import {
  actOnKey, Clock, followHands, Inputs, linkOf, readLink, showLink,
} from "./controls.js";
import { showRecord, unitsText, unitText, wordsOf } from "./record.js";

const FRAME = 1 / 60;  // seconds
const FAST = 0.8;      // radians of spin per frame that the eye cannot follow

class Page {
  constructor(elements) {
    this.at = elements;
    this.units = UNITS;
    this.camera = new Camera();
    this.shown = {};
    this.look = readLook();
    this.clock = new Clock(elements, () => this.stale());
    this.inputs = new Inputs(elements.inputs, (name, x, text) => this.change(name, x, text));
    this.offerExamples();
    this.listen();
    this.start();
  }

  /** Begin, moving unless the reader wants things to stand still. */
  start() {
    this.follow();
    this.clock.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    requestAnimationFrame((now) => this.frame(now, now));
  }

  /** Show the scene of the address, if it carries one, else the one that was given. */
  follow() {
    let linked = {};
    let complaint = "";
    try {
      linked = readLink(location.hash);
      motionOf({ ...SCENE, ...linked });
    } catch (error) {
      linked = {};
      complaint = `The link was not understood: ${error.message}`;
    }
    const { t = 0, ...inputs } = linked;
    this.show({ ...SCENE, ...inputs }, true);
    const near = this.clock.reaches(t);
    this.clock.set(near ? t : 0);
    this.complain(near ? complaint : `The link was not understood: t = ${t} is too far away`);
  }

  /** Offer the scene of the file and the shipped ones; a choice shows its first line and moves. */
  offerExamples() {
    const { examples, reset, remark } = this.at;
    const own = { remark: "", inputs: SCENE };
    const all = { "This scene": own, ...EXAMPLES };
    examples.append(...Object.keys(all).map((name) => new Option(name)));
    const choose = () => {
      const scene = all[examples.value];
      this.units = scene === own ? UNITS : {};
      remark.textContent = scene.remark;
      this.camera.reset();
      this.show(scene.inputs, true);
      this.clock.set(0);
    };
    examples.addEventListener("change", choose);
    reset.addEventListener("click", () => { examples.selectedIndex = 0; choose(); });
  }

  listen() {
    const { space, plots, periods, waves, copy, theme, save, kind, record, explained } = this.at;
    followHands(space, this.camera, () => this.stale());
    for (const box of document.querySelectorAll("[data-shows]")) {
      const note = () => { this.shown[box.dataset.shows] = box.checked; };
      note();
      box.addEventListener("change", () => { note(); this.stale(); });
    }
    for (const part of [periods, waves]) part.addEventListener("change", () => this.recurve());
    copy.addEventListener("click", () => this.copyLink());
    theme.addEventListener("click", () => this.changeTheme());
    save.addEventListener("click", () => this.save(kind.value));
    record.addEventListener("focusin", (event) => { explained.textContent = event.target.title; });
    const scrub = (event) => {
      if (event.buttons) this.clock.set(this.field.valueAt(event.offsetX));
    };
    plots.addEventListener("pointerdown", scrub);
    plots.addEventListener("pointermove", scrub);
    new ResizeObserver(() => this.recurve()).observe(document.body);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.relook());
    window.addEventListener("hashchange", () => this.follow());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  /** Keys that hold wherever no control takes them. */
  key(event) {
    if (event.target.closest("input, select, button, tr") || event.ctrlKey || event.metaKey) return;
    const keys = {
      " ": () => this.clock.play(!this.clock.playing),
      ArrowLeft: () => this.clock.step(-1, event.shiftKey),
      ArrowRight: () => this.clock.step(1, event.shiftKey),
      Home: () => this.clock.set(0),
    };
    actOnKey(event, keys);
  }

  /** Change one input; a value that cannot be leaves the scene as it was, and is said. */
  change(name, x, text) {
    const scene = { ...this.scene, [name]: x };
    const { slider } = this.inputs.fields[name];
    const rescaled = Number(slider.max) < x || Number(slider.min) > x;
    try {
      this.show(scene, rescaled, false);
    } catch (error) {
      const given = text || "nothing";
      this.complain(Number.isNaN(x) ? `${name} must be a number, got ${given}` : error.message);
    }
  }

  /** Show another scene; `anew` sets the ranges of the sliders, and the usual speed. */
  show(scene, anew, freshSpeed = anew) {
    this.motion = motionOf(scene);
    this.scene = scene;
    if (anew) this.inputs.rescale(scene);
    else this.inputs.show(scene);
    this.inputs.nameUnits(this.units);
    this.at.units.textContent = unitsText(this.units);
    const [title, text] = wordsOf(this.motion, this.units);
    if (this.at.title.textContent !== title) this.at.title.textContent = title;
    this.at.words.textContent = text;
    document.title = `${title} · lagtop`;
    showRecord(this.at.record, this.motion.record, this.units);
    this.recurve();
    this.clock.adapt(windowOf(this.motion, 1), freshSpeed);
    this.complain("");
  }

  complain(message) {
    const name = Object.keys(INPUTS).find((key) => message.startsWith(`${key} `));
    this.at.error.textContent = name ? `${INPUTS[name].symbol}${message.slice(name.length)}. `
      + "The page shows the last valid scene." : message;
    document.body.classList.toggle("refused", name !== undefined);
    this.inputs.mark(message);
  }

  recurve() {
    this.curves = null;
    this.stale();
  }

  /** Something has changed: draw with the next frame. */
  stale() {
    this.fresh = false;
  }

  relook() {
    this.look = readLook();
    this.recurve();
  }

  changeTheme() {
    const root = document.documentElement;
    const dark = root.dataset.theme
      ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    this.relook();
  }

  /** Save the picture in space, the curves of the window, or the scene as a file. */
  save(kind) {
    if (!this.fresh) this.draw();
    const download = (blob) => {
      const link = document.createElement("a");
      Object.assign(link, { href: URL.createObjectURL(blob), download: `top.${kind}` });
      link.click();
      URL.revokeObjectURL(link.href);
    };
    const { times, samples } = this.curves;
    const rows = samples.map(({ theta, phi, psi }, i) => (
      [times[i], ...[theta, phi, psi].map((x) => x * 180 / Math.PI)].join(",")));
    const scene = Object.entries(this.scene).map(([name, x]) => `${name} = ${x}\n`);
    if (kind === "png") this.at.space.toBlob(download);
    if (kind === "csv") {
      const table = ["t,theta_deg,phi_deg,psi_deg", ...rows, ""].join("\n");
      download(new Blob([table], { type: "text/csv" }));
    }
    if (kind === "toml") download(new Blob(scene, { type: "application/toml" }));
  }

  async copyLink() {
    showLink(this.scene, this.clock.t);
    const link = location.href.split("#")[0] + linkOf(this.scene, this.clock.t);
    try {
      await navigator.clipboard.writeText(link);
      this.at.copied.textContent = "copied";
    } catch {
      this.at.copied.textContent = "it is in the address bar";
    }
  }

  frame(now, last) {
    const moved = this.clock.pass(Math.min((now - last) / 1000, 0.1));
    if (moved || !this.fresh) this.draw();
    requestAnimationFrame((next) => this.frame(next, now));
  }

  draw() {
    this.fresh = true;
    const { motion, clock } = this;
    const span = windowOf(motion, Number(this.at.periods.value));
    const { curves } = this;
    if (!curves || clock.t < curves.from || clock.t >= curves.from + curves.span) {
      this.curves = curvesAt(motion, span, clock.t);
      const unit = unitText("time", this.units);
      const waves = this.at.waves.checked;
      this.field = drawPlots(this.at.plots, this.look, this.curves, waves, unit);
      this.placeOnCubic = drawCubic(this.at.cubic, this.look, motion);
      this.report();
    }
    const angles = motion.angles(clock.t);
    this.drawNow(angles);
    if (!clock.playing) this.report(angles);
  }

  drawNow(angles) {
    const { motion, clock, field, curves, look } = this;
    const blurred = clock.playing && Math.abs(motion.start.r0) * clock.speed * FRAME > FAST;
    drawSpace(this.at.space, this.camera, look, {
      motion, curves, t: clock.t, angles, blurred, shown: this.shown,
    });
    this.at.cursor.style.transform = `translateX(${field.x(clock.t)}px)`;
    const place = this.placeOnCubic(angles.theta);
    this.at.point.hidden = !place;
    if (place) this.at.point.style.transform = `translate(${place[0]}px, ${place[1]}px)`;
    this.at.now.textContent = ["theta", "phiWithin", "psiWithin"]
      .map((name, i) => `${"ϑφψ"[i]} = ${(angles[name] * 180 / Math.PI).toFixed(2)}°`)
      .join("   ").replace(/-/g, "−");
  }

  /** Say what is to be seen to those who do not see it, and put the scene into the address. */
  report(angles = this.motion.angles(this.clock.t)) {
    const said = (angles.theta * 180 / Math.PI).toFixed(1);
    this.at.space.setAttribute("aria-label",
      `The top in space at t = ${Number(this.clock.t.toPrecision(5))}, tilted by ${said} degrees. `
      + `${this.at.title.textContent}. Drag or press arrows to turn it.`);
    clearTimeout(this.linking);
    this.linking = setTimeout(() => showLink(this.scene, this.clock.t), 300);
  }
}

const elements = Object.fromEntries(
  [...document.querySelectorAll("[id]")].map((element) => [element.id, element]));
window.lagtop = { motionOf, frameOf, onLid, page: new Page(elements) };  // for a console
