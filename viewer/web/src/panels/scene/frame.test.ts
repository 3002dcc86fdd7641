// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { frameOf, lensIn } from './frame';

const array = (data: number[]) => ({ $ndarray: { type: 'float64', shape: [data.length], data } });
const pose = (x: number) => ({ position: array([x, 0, 1]), orientation: array([1, 0, 0, 0]) });
const calibration = { fx: 90, fy: 91, cx: 63.5, cy: 47.5, pose_head_camera: pose(9) };
const memory: Record<string, unknown> = { view: { image: { $image: { channels: 3 } }, pose_world_camera: pose(2), calibration: { $link: 'cal' }, joints: { $link: 'joints' } }, cal: calibration };

describe('a camera', () => {
  it('tells how it sees, plainly or as a matrix', () => {
    expect(lensIn(calibration)).toEqual({ fx: 90, fy: 91, cx: 63.5, cy: 47.5 });
    expect(lensIn({ k: array([90, 0, 63.5, 0, 91, 47.5, 0, 0, 1]) })).toEqual({ fx: 90, fy: 91, cx: 63.5, cy: 47.5 });
    expect(lensIn({ fx: 0, fy: 91, cx: 1, cy: 1 })).toBeUndefined();
    expect(lensIn({ k: array([90]) })).toBeUndefined();
  });
  it('of a depth image is found by its links', async () => {
    const asked: string[] = [];
    const found = await frameOf({ depth: { $image: {} }, view: { $link: 'view' } }, async (id) => { asked.push(id); return memory[id]; });
    expect(found.pose!.position[0]).toBe(2);
    expect(found.lens!.fx).toBe(90);
    expect(found.picture).toEqual({ id: 'view', path: 'image' });
    expect(asked).toEqual(['view', 'cal']);
  });
  it('that was forgotten is told by nobody', async () => {
    expect(await frameOf({ view: { $link: 'gone' } }, async () => { throw new Error('not found'); })).toEqual({});
    const loop = { view: { $link: 'loop' } };
    expect(await frameOf(loop, async () => loop)).toEqual({});
  });
});
