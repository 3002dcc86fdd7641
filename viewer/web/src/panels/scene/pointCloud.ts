// SPDX-License-Identifier: Apache-2.0
// Points in the picture: as the camera saw them, or coloured by how far they are from it.
import * as THREE from 'three';
import type { Cloud } from './clouds';

/** Points beyond the share of them that is this near have the colour of far ones. */
const kNearShare = 0.95;
const kSamples = 2_000;

/** A distance that most points are nearer than. */
export function reachOf(points: Float32Array): number {
  const count = points.length / 3;
  const distances: number[] = [];
  for (let i = 0; i < count; i += Math.max(1, Math.floor(count / kSamples))) distances.push(Math.hypot(points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!));
  distances.sort((a, b) => a - b);
  return distances[Math.floor(kNearShare * (distances.length - 1))] ?? 1;
}

/** Colours by distance, from those near to those far. */
function byDistance(points: Float32Array, near: string, far: string): Uint8Array {
  const [a, b] = [new THREE.Color(near), new THREE.Color(far)];
  const colours = new Uint8Array(points.length);
  const reach = reachOf(points) || 1;
  const [from, to] = [[a.r, a.g, a.b], [b.r, b.g, b.b]] as const;
  for (let i = 0; i < points.length; i += 3) {
    const share = Math.min(1, Math.hypot(points[i]!, points[i + 1]!, points[i + 2]!) / reach);
    for (let c = 0; c < 3; ++c) colours[i + c] = 255 * (from[c]! + (to[c]! - from[c]!) * share);
  }
  return colours;
}

export function cloudObject(cloud: Cloud, near: string, far: string): THREE.Points {
  const { points } = cloud;
  const colours = cloud.colours ?? byDistance(points, near, far);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3, true));
  const object = new THREE.Points(geometry, new THREE.PointsMaterial({ size: 1.6, sizeAttenuation: false, vertexColors: true }));
  if (cloud.pose) {
    object.position.set(...cloud.pose.position);
    const [w, x, y, z] = cloud.pose.orientation;
    object.quaternion.set(x, y, z, w).normalize();
  }
  return object;
}
