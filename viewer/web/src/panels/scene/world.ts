// SPDX-License-Identifier: Apache-2.0
// The picture of the scene: boxes, axes and frusta, z up as in Engram's frame of the world.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Theme } from '../../ui/theme';
import { flagObject, kFlagHeight } from './floor';
import { kHalfView } from './frame';
import type { Placed } from './poses';

export interface Thing {
  readonly id: string;
  readonly label: string;
  readonly placed: Placed;
  readonly isPredicted: boolean;
  readonly isChosen: boolean;
  /** A named place, which has a flag. */
  readonly isFlag?: boolean;
}

export interface Anchor {
  readonly id: string;
  readonly label: string;
  readonly isChosen: boolean;
  readonly x: number;
  readonly y: number;
}

export interface World {
  readonly show: (things: readonly Thing[], theme: Theme) => void;
  /** Puts an object into the scene, in the place of the one that had this name; null takes it away. What is replaced is freed, unless it is kept by who made it. */
  readonly setPart: (name: string, object: THREE.Object3D | null, isKept?: boolean) => void;
  readonly resize: (width: number, height: number) => void;
  readonly dispose: () => void;
  readonly canvas: HTMLCanvasElement;
}

/** How far a frustum is drawn. */
export const kViewDepth_m = 0.5;

/** Four edges and the far rectangle of what a camera sees. */
function frustum(colour: THREE.Color, half: readonly [number, number]): THREE.LineSegments {
  const depth = kViewDepth_m;
  const [x, y] = [half[0] * depth, half[1] * depth];
  const corners = [[-x, -y, depth], [x, -y, depth], [x, y, depth], [-x, y, depth]] as const;
  const points: number[] = [];
  corners.forEach((corner, i) => points.push(0, 0, 0, ...corner, ...corner, ...corners[(i + 1) % 4]!));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour }));
}

function boxOf(size: readonly [number, number, number], colour: THREE.Color, isGhost: boolean): THREE.Object3D {
  const geometry = new THREE.BoxGeometry(...size);
  const box = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: colour, transparent: isGhost, opacity: isGhost ? 0.35 : 1 }));
  box.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry), new THREE.LineBasicMaterial({ color: colour.clone().multiplyScalar(0.6) })));
  return box;
}

function free(object: THREE.Object3D): void {
  object.traverse((part) => {
    const mesh = part as Partial<THREE.Mesh>;
    mesh.geometry?.dispose();
    const material = mesh.material;
    for (const one of Array.isArray(material) ? material : material ? [material] : []) {
      (one as THREE.MeshBasicMaterial).map?.dispose();
      one.dispose();
    }
  });
}

/** Small things are told apart by their colours; furniture is quiet. */
function ownColour(thing: Thing, theme: Theme): string {
  if (!thing.placed.size) return theme.hover;
  if (Math.max(...thing.placed.size) > 0.6) return theme.faint;
  let hash = 0;
  for (const c of thing.id) hash = (hash * 31 + c.charCodeAt(0)) >>> 0;
  return theme.series[hash % theme.series.length]!;
}

/** Leaves out labels that would lie on others; those of what is chosen come first. */
export function apart(anchors: readonly Anchor[]): Anchor[] {
  const kept: Anchor[] = [];
  const width = (label: string) => label.length * 6 + 8;
  for (const anchor of [...anchors].sort((a, b) => Number(b.isChosen) - Number(a.isChosen)))
    if (kept.every((other) => Math.abs(other.y - anchor.y) > 15 || Math.abs(other.x - anchor.x) > (width(other.label) + width(anchor.label)) / 2)) kept.push(anchor);
  return kept;
}

export function createWorld(onAnchors: (anchors: readonly Anchor[]) => void): World {
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(2, devicePixelRatio));
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(45, 1, 0.02, 200);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, renderer.domElement);
  const light = new THREE.DirectionalLight('#ffffff', 1.6);
  light.position.set(-2, -4, 6);
  scene.add(light, new THREE.AmbientLight('#ffffff', 1.3));
  const content = new THREE.Group();
  const parts = new Map<string, { object: THREE.Object3D; isKept: boolean }>();
  let grid: THREE.GridHelper | null = null;
  let shown: readonly Thing[] = [];
  let size = { width: 1, height: 1 };
  let frame = 0;
  scene.add(content);

  const draw = (): void => {
    frame = 0;
    renderer.render(scene, camera);
    onAnchors(apart(shown.map((thing) => {
      const at = new THREE.Vector3(...thing.placed.position);
      at.z += thing.isFlag ? kFlagHeight + 0.04 : (thing.placed.size?.[2] ?? 0.1) / 2 + 0.04;
      at.project(camera);
      return { id: thing.id, label: thing.label, isChosen: thing.isChosen, x: at.z > 1 ? -999 : ((at.x + 1) / 2) * size.width, y: ((1 - at.y) / 2) * size.height };
    })));
  };
  let isFitted = false;
  /** Stands where everything is in the picture; only once, for later the person decides. */
  const fit = (things: readonly Thing[]): void => {
    if (isFitted || things.length === 0) return;
    isFitted = true;
    const sphere = new THREE.Box3().setFromObject(content).getBoundingSphere(new THREE.Sphere());
    controls.target.copy(sphere.center);
    camera.position.copy(sphere.center).addScaledVector(new THREE.Vector3(-0.42, -1, 0.72).normalize(), Math.max(0.6, sphere.radius) * 1.5);
    controls.update();
  };
  // Drawn when something changed, not sixty times a second.
  const ask = (): void => { frame ||= requestAnimationFrame(draw); };
  controls.addEventListener('change', ask);

  const objectOf = (thing: Thing, theme: Theme): THREE.Object3D => {
    const colour = new THREE.Color(thing.isPredicted ? theme.predicted : thing.isChosen ? theme.accent : thing.isFlag ? theme.mark : ownColour(thing, theme));
    const { placed } = thing;
    const object = thing.isFlag ? flagObject(colour) : placed.isCamera ? frustum(colour, placed.half ?? [kHalfView, kHalfView]) : placed.size ? boxOf(placed.size, colour, thing.isPredicted) : new THREE.Group();
    if (!placed.isCamera && !thing.isFlag) object.add(new THREE.AxesHelper(placed.size ? 0.12 : 0.3));
    object.position.set(...placed.position);
    const [w, x, y, z] = placed.orientation;
    object.quaternion.set(x, y, z, w).normalize();
    return object;
  };

  return {
    canvas: renderer.domElement,
    show(things, theme) {
      free(content);
      content.clear();
      if (grid) { free(grid); scene.remove(grid); }
      grid = new THREE.GridHelper(8, 16, new THREE.Color(theme.faint), new THREE.Color(theme.line));
      grid.rotation.x = Math.PI / 2;
      scene.add(grid);
      shown = things;
      for (const thing of things) content.add(objectOf(thing, theme));
      fit(things);
      ask();
    },
    setPart(name, object, isKept = false) {
      const before = parts.get(name);
      if (before && before.object !== object) {
        scene.remove(before.object);
        if (!before.isKept) free(before.object);
        parts.delete(name);
      }
      if (object) {
        parts.set(name, { object, isKept });
        scene.add(object);
      }
      ask();
    },
    resize(width, height) {
      size = { width, height };
      renderer.setSize(width, height);
      camera.aspect = width / Math.max(1, height);
      camera.updateProjectionMatrix();
      ask();
    },
    dispose() {
      cancelAnimationFrame(frame);
      controls.dispose();
      free(scene);
      renderer.dispose();
      // Browsers have a few contexts alone, and free those of closed panels late.
      renderer.forceContextLoss();
    },
  };
}
