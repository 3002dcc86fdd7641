// SPDX-License-Identifier: Apache-2.0
// Wheel, drag and pinch on the timeline, as calls of what they mean.

export interface Gestures {
  /** Zoom around pixel `x`; below 1 is closer. */
  readonly zoom: (x: number, factor: number) => void;
  /** Move the picture by pixels, to the side and down. */
  readonly pan: (dx: number, dy: number) => void;
  readonly hover: (x: number | null) => void;
  readonly pick: (x: number, y: number) => void;
  readonly scrub: (x: number) => void;
  readonly select: (from: number, to: number) => void;
  /** Where a drag moves the cursor and not the picture: the axis above the lanes. */
  readonly isScrubbing: (y: number) => boolean;
}

interface Finger {
  x: number;
  y: number;
}

const kClickPixels = 4;

/** Listens on an element; the function that it gives stops it. */
export function listen(element: HTMLElement, to: Gestures): () => void {
  const fingers = new Map<number, Finger>();
  let start: Finger | null = null;
  let mode: 'none' | 'pan' | 'scrub' | 'select' | 'pinch' = 'none';
  let moved = false;
  const at = (event: MouseEvent): Finger => {
    const box = element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  const onWheel = (event: WheelEvent): void => {
    event.preventDefault();
    const { x } = at(event);
    const unit = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 300 : 1;
    // Sideways wheels and shift move; alt scrolls the lanes; everything else zooms,
    // pinching on a touch pad too (ctrlKey).
    if (event.altKey) to.pan(0, event.deltaY * unit);
    else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) to.pan((event.deltaX || event.deltaY) * unit, 0);
    else to.zoom(x, Math.exp(Math.max(-300, Math.min(300, event.deltaY * unit)) * (event.ctrlKey ? 0.01 : 0.002)));
  };

  const onDown = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, at(event));
    moved = false;
    if (fingers.size >= 2) {
      mode = 'pinch';
      return;
    }
    start = at(event);
    mode = event.shiftKey ? 'select' : to.isScrubbing(start.y) ? 'scrub' : 'pan';
    if (mode === 'scrub') to.scrub(start.x);
  };

  const pinch = (id: number, next: Finger): void => {
    const here = fingers.get(id)!;
    const [, other] = [...fingers].find(([key]) => key !== id) ?? [];
    // The finger that is left of two means nothing until it is lifted, too.
    if (!other) return;
    const before = Math.max(8, Math.abs(here.x - other.x));
    const after = Math.max(8, Math.abs(next.x - other.x));
    to.zoom((next.x + other.x) / 2, before / after);
    to.pan((here.x - next.x) / 2, 0);
  };

  const onMove = (event: PointerEvent): void => {
    const here = at(event);
    const before = fingers.get(event.pointerId);
    if (!before) return to.hover(here.x);
    if (mode === 'pinch') pinch(event.pointerId, here);
    fingers.set(event.pointerId, here);
    if (start === null || mode === 'pinch') return;
    moved ||= Math.hypot(here.x - start.x, here.y - start.y) > kClickPixels;
    if (mode === 'scrub') to.scrub(here.x);
    else if (moved && mode === 'pan') to.pan(before.x - here.x, before.y - here.y);
    else if (moved && mode === 'select') to.select(start.x, here.x);
  };

  const onUp = (event: PointerEvent): void => {
    if (!fingers.delete(event.pointerId)) return;
    // What the browser takes over (pointercancel) was no click.
    if (event.type === 'pointerup' && mode === 'pan' && !moved && start) to.pick(start.x, start.y);
    if (fingers.size === 0) {
      mode = 'none';
      start = null;
    }
  };

  // Else a drag with shift would mark the text of the whole page. It keeps the focus from coming, too.
  const onMouseDown = (event: MouseEvent): void => {
    event.preventDefault();
    element.focus({ preventScroll: true });
  };

  const onLeave = (): void => to.hover(null);
  element.addEventListener('wheel', onWheel, { passive: false });
  element.addEventListener('mousedown', onMouseDown);
  element.addEventListener('pointerdown', onDown);
  element.addEventListener('pointermove', onMove);
  element.addEventListener('pointerup', onUp);
  element.addEventListener('pointercancel', onUp);
  element.addEventListener('pointerleave', onLeave);
  return () => {
    element.removeEventListener('wheel', onWheel);
    element.removeEventListener('mousedown', onMouseDown);
    element.removeEventListener('pointerdown', onDown);
    element.removeEventListener('pointermove', onMove);
    element.removeEventListener('pointerup', onUp);
    element.removeEventListener('pointercancel', onUp);
    element.removeEventListener('pointerleave', onLeave);
  };
}
