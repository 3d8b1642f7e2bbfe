// The camera, an orthographic view of the unit sphere, and the hands that move it.

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
export function combined(x, p, y, q, z = 0, r = p) {
  return [0, 1, 2].map((i) => x * p[i] + y * q[i] + z * r[i]);
}

/** The frame of a body at its Euler angles: line of nodes, figure axis, and across both. */
export function frameOf({ theta, psi }) {
  const [st, ct] = [Math.sin(theta), Math.cos(theta)];
  const [sp, cp] = [Math.sin(psi), Math.cos(psi)];
  return { nodes: [cp, sp, 0], axis: [st * sp, -st * cp, ct], across: [-ct * sp, ct * cp, st] };
}

/** A vector times a number. */
export function scaled(p, factor) {
  return p.map((x) => factor * x);
}

/** Turn a camera by drag and arrows, zoom by pinch, wheel, + and -; each calls `moved()`. */
export function followHands(canvas, camera, moved) {
  const fingers = new Map();
  const spread = () => {
    const [p, q] = [...fingers.values()];
    return Math.hypot(p.x - q.x, p.y - q.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture?.(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const before = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2) camera.magnify(spread() / Math.max(before, 1));
    else camera.turn((event.clientX - last.x) * 0.5, (event.clientY - last.y) * 0.5);
    moved();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.magnify(Math.exp(-event.deltaY / 500));
    moved();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => {
    camera.reset();
    moved();
  });
  const moves = {
    ArrowLeft: () => camera.turn(-5, 0),
    ArrowRight: () => camera.turn(5, 0),
    ArrowUp: () => camera.turn(0, 5),
    ArrowDown: () => camera.turn(0, -5),
    "+": () => camera.magnify(1.2),
    "-": () => camera.magnify(1 / 1.2),
    0: () => camera.reset(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (actOnKey(event, moves)) moved();
  });
}

/** Run the action that a table has for the key of an event; return whether it has one. */
export function actOnKey(event, actions) {
  if (!actions[event.key]) return false;
  event.preventDefault();
  event.stopPropagation();
  actions[event.key]();
  return true;
}
