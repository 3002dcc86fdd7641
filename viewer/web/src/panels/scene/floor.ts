// SPDX-License-Identifier: Apache-2.0
// What lies on the floor of the scene: a cost map, a plan, and flags of places.
import * as THREE from 'three';
import { coloursOfCosts, type CostMap } from './costMap';
import type { Planar } from './plans';

/** Heights in m, so that none flickers through another. */
const kMapHeight = 0.004;
const kPlanHeight = 0.02;
const kPlanWidth = 0.05;
const kDash = { on: 0.12, off: 0.09 } as const;
const kArrow = { length: 0.26, width: 0.2 } as const;
export const kFlagHeight = 0.7;

export function mapObject(map: CostMap): THREE.Mesh {
  const texture = new THREE.DataTexture(coloursOfCosts(map.costs), map.columns, map.rows, THREE.RGBAFormat);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.magFilter = THREE.NearestFilter;
  texture.needsUpdate = true;
  const [width, height] = [map.columns * map.resolution, map.rows * map.resolution];
  const geometry = new THREE.PlaneGeometry(width, height).translate(width / 2, height / 2, 0);
  const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false, side: THREE.DoubleSide }));
  mesh.position.set(map.corner[0], map.corner[1], kMapHeight);
  mesh.rotation.z = map.corner[2];
  return mesh;
}

type Point = readonly [number, number];

/** Stretches of a way: all of it, or dashes. */
export function stretchesOf(path: readonly Planar[], isDashed: boolean): (readonly [Point, Point])[] {
  const stretches: (readonly [Point, Point])[] = [];
  let along = 0;
  for (let i = 1; i < path.length; ++i) {
    const [a, b] = [path[i - 1]!, path[i]!];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (!(length > 0)) continue;
    const at = (s: number): Point => [a[0] + ((b[0] - a[0]) * s) / length, a[1] + ((b[1] - a[1]) * s) / length];
    if (!isDashed) stretches.push([at(0), at(length)]);
    else {
      const period = kDash.on + kDash.off;
      for (let k = Math.floor(along / period); k * period < along + length && stretches.length < 5_000; ++k) {
        const [from, to] = [Math.max(0, k * period - along), Math.min(length, k * period + kDash.on - along)];
        if (to > from) stretches.push([at(from), at(to)]);
      }
    }
    along += length;
  }
  return stretches;
}

function flat(triangles: readonly Point[], colour: THREE.ColorRepresentation, opacity: number): THREE.Mesh {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(triangles.flatMap(([x, y]) => [x, y, kPlanHeight]), 3));
  return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: colour, side: THREE.DoubleSide, transparent: opacity < 1, opacity }));
}

const arrowAt = ([x, y, heading]: Planar): Point[] => {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  const to = (forward: number, left: number): Point => [x + c * forward - s * left, y + s * forward + c * left];
  return [to(kArrow.length, 0), to(0, kArrow.width / 2), to(0, -kArrow.width / 2)];
};

/** A way as a ribbon, with an arrow at its end that points where the robot will look. */
export function planObject(path: readonly Planar[], colour: string, isDashed: boolean): THREE.Object3D {
  const ribbon = stretchesOf(path, isDashed).flatMap(([a, b]): Point[] => {
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const [nx, ny] = [((a[1] - b[1]) / length) * (kPlanWidth / 2), ((b[0] - a[0]) / length) * (kPlanWidth / 2)];
    const corners: [Point, Point, Point, Point] = [[a[0] + nx, a[1] + ny], [a[0] - nx, a[1] - ny], [b[0] - nx, b[1] - ny], [b[0] + nx, b[1] + ny]];
    return [corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]];
  });
  const group = new THREE.Group();
  const opacity = isDashed ? 0.7 : 1;
  if (ribbon.length > 0) group.add(flat(ribbon, colour, opacity));
  const goal = path.at(-1);
  if (goal) group.add(flat(arrowAt(goal), colour, opacity));
  return group;
}

/** A flag with its foot at the origin; the arrow on the floor tells where the robot looks there. */
export function flagObject(colour: THREE.Color): THREE.Object3D {
  const group = new THREE.Group();
  const pole = new THREE.Mesh(new THREE.CylinderGeometry(0.014, 0.014, kFlagHeight, 8).rotateX(Math.PI / 2).translate(0, 0, kFlagHeight / 2), new THREE.MeshLambertMaterial({ color: colour }));
  const cloth = new THREE.BufferGeometry();
  cloth.setAttribute('position', new THREE.Float32BufferAttribute([0, 0, kFlagHeight, -0.28, 0, kFlagHeight - 0.09, 0, 0, kFlagHeight - 0.18], 3));
  group.add(pole, new THREE.Mesh(cloth, new THREE.MeshBasicMaterial({ color: colour, side: THREE.DoubleSide })), flat(arrowAt([0.05, 0, 0]), colour, 0.9));
  return group;
}
