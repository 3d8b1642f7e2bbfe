// Hands on the picture: drag to turn, pinch or wheel to zoom, arrows and + - on the keyboard.

/** Let hands move a camera; `moved()` is called after each move. */
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
  canvas.addEventListener("keydown", (event) => {
    if (!moveByKey(camera, event.key)) return;
    event.preventDefault();
    event.stopPropagation();
    moved();
  });
}

function moveByKey(camera, key) {
  const moves = {
    ArrowLeft: () => camera.turn(-5, 0),
    ArrowRight: () => camera.turn(5, 0),
    ArrowUp: () => camera.turn(0, 5),
    ArrowDown: () => camera.turn(0, -5),
    "+": () => camera.magnify(1.2),
    "-": () => camera.magnify(1 / 1.2),
    0: () => camera.reset(),
  };
  moves[key]?.();
  return key in moves;
}
