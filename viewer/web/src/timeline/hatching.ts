// SPDX-License-Identifier: Apache-2.0
// Oblique lines, for what is not recorded.
import { SvgPen, type Pen } from '../ui/svg';

const patterns = new Map<string, CanvasPattern>();

/** Thin diagonals in a colour, as a style to fill with. */
export function hatching(c: Pen, colour: string): CanvasPattern | string {
  if (c instanceof SvgPen) return c.hatch(colour);
  const known = patterns.get(colour);
  if (known) return known;
  const tile = document.createElement('canvas');
  tile.width = tile.height = 16;
  const t = tile.getContext('2d')!;
  t.strokeStyle = colour;
  t.lineWidth = 1.5;
  for (const shift of [-8, 0, 8, 16]) {
    t.moveTo(shift - 1, 17);
    t.lineTo(shift + 17, -1);
  }
  t.stroke();
  const pattern = t.createPattern(tile, 'repeat');
  if (!pattern) return colour;
  patterns.set(colour, pattern);
  return pattern;
}
