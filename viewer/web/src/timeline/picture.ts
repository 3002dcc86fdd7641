// SPDX-License-Identifier: Apache-2.0
// The timeline as one picture to save: names, lanes and axis, as they are on the screen.
import { kFont, type Pen } from '../ui/svg';
import type { Theme } from '../ui/theme';
import { drawLanes, type LaneView } from './draw';
import { kRowHeight } from './layout';
import { drawOverlay, kAxisHeight, type Overlay } from './overlay';

export const kNamesWidth = 240;

function clipTo(c: Pen, x: number, y: number, width: number, height: number): void {
  c.save();
  c.beginPath();
  c.rect(x, y, width, height);
  c.clip();
}

function drawNames(c: Pen, view: LaneView, theme: Theme): void {
  c.textBaseline = 'middle';
  for (let i = view.first; i < view.rows.length; ++i) {
    const row = view.rows[i]!;
    const y = i * kRowHeight - view.scrollTop;
    if (y > view.height) break;
    c.font = row.isEntity ? kFont : `600 ${kFont}`;
    c.fillStyle = row.isEntity ? theme.ink : theme.dim;
    c.fillText(row.label, 8 + row.depth * 13, y + kRowHeight / 2);
  }
}

export function drawTimeline(c: Pen, lanes: LaneView, overlay: Overlay, theme: Theme): void {
  c.fillStyle = theme.panel;
  c.fillRect(0, 0, kNamesWidth + overlay.width, overlay.height);
  clipTo(c, 0, kAxisHeight, kNamesWidth - 6, lanes.height);
  c.translate(0, kAxisHeight);
  drawNames(c, lanes, theme);
  c.restore();
  clipTo(c, kNamesWidth, kAxisHeight, lanes.width, lanes.height);
  c.translate(kNamesWidth, kAxisHeight);
  drawLanes(c, lanes, theme);
  c.restore();
  clipTo(c, kNamesWidth, 0, overlay.width, overlay.height);
  c.translate(kNamesWidth, 0);
  drawOverlay(c, overlay, theme);
  c.restore();
}
