// SPDX-License-Identifier: Apache-2.0
// What cameras see, at the far end of their frusta; once the cursor rests, because images are large.
import { createEffect, onCleanup, type Accessor } from 'solid-js';
import * as THREE from 'three';
import { getImage } from '../../api/client';
import { isMoving } from '../../state/moving';
import { createRequest } from '../../state/request';
import { colourPath } from './frame';
import { isInWorld, type Placed } from './poses';
import { valueOf, type Found } from './sources';
import { kViewDepth_m } from './world';

const kMaxViews = 4;

/** A picture in the frame of its camera: x right and y down, as the rows of an image go. */
function viewObject(bitmap: ImageBitmap, placed: Placed): THREE.Mesh {
  const texture = new THREE.Texture(bitmap as unknown as HTMLImageElement);
  texture.flipY = false;
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.needsUpdate = true;
  texture.addEventListener('dispose', () => bitmap.close());
  const [x, y] = placed.half ?? [1, 1];
  const geometry = new THREE.PlaneGeometry(2 * x * kViewDepth_m, 2 * y * kViewDepth_m).translate(0, 0, kViewDepth_m);
  const object = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide }));
  object.position.set(...placed.position);
  const [qw, qx, qy, qz] = placed.orientation;
  object.quaternion.set(qx, qy, qz, qw).normalize();
  return object;
}

export function createViews(seen: Accessor<readonly (Found & { readonly places: readonly Placed[] })[]>, show: (views: readonly THREE.Object3D[]) => void): void {
  let kept = { key: '', views: [] as THREE.Object3D[] };
  const views = createRequest<readonly THREE.Object3D[]>(() => {
    const cameras = seen().flatMap((one) => {
      const placed = one.places.find((place) => place.isCamera && isInWorld(place));
      const path = colourPath(valueOf(one));
      return placed && path !== undefined && one.moment.source !== 'predicted' ? [{ id: `${one.moment.id}/0`, path, placed }] : [];
    }).slice(0, kMaxViews);
    const key = cameras.map((camera) => camera.id).join(' ');
    if (cameras.length === 0 || (isMoving() && key !== kept.key)) return null;
    return {
      group: key,
      run: async (signal) => {
        if (key === kept.key) return kept.views;
        const bitmaps = await Promise.all(cameras.map(async (camera) => ({ placed: camera.placed, picture: await getImage({ id: camera.id, path: camera.path, as: 'jpeg' }, signal).catch(() => null) })));
        signal.throwIfAborted();
        kept = { key, views: bitmaps.flatMap(({ placed, picture }) => (picture ? [viewObject(picture.bitmap, placed)] : [])) };
        return kept.views;
      },
    };
  });
  createEffect(() => {
    const now = views.data() ?? [];
    // Those that are taken away are freed, and cannot be shown again.
    if (now !== kept.views) kept = { key: '', views: [] };
    show(now);
  });
  onCleanup(() => show([]));
}
