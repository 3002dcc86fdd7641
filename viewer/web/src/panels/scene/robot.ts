// SPDX-License-Identifier: Apache-2.0
// A robot as its URDF describes it. This file and the loader come when a memory has a URDF.
//
// The loader never sees what would make it ask for a file: meshes and textures are taken out of the
// document before, and counted. vite.config.ts leaves the loaders of meshes out of the page.
import * as THREE from 'three';
import URDFLoader, { type URDFRobot } from 'urdf-loader';
import type { Placed } from './poses';
import { checkNumbers, checkTree, kMaxShapes, kMaxUrdfChars, kMaxUrdfElements, UrdfError, type UrdfJoint } from './urdf';

const kJointTypes = new Set(['revolute', 'continuous', 'prismatic', 'fixed', 'floating', 'planar']);
const kSolids = new Set(['box', 'cylinder', 'sphere']);

/** The loader takes <Link> for <link>. */
const nameOf = (element: Element): string => element.nodeName.toLowerCase();
const childrenOf = (element: Element, name: string): Element[] => [...element.children].filter((child) => nameOf(child) === name);
const attribute = (element: Element | undefined, name: string): string => element?.getAttribute(name) ?? '';

function checkOrigin(parent: Element, where: string): void {
  for (const origin of childrenOf(parent, 'origin'))
    for (const name of ['xyz', 'rpy']) if (origin.hasAttribute(name)) checkNumbers(attribute(origin, name), 3, `${name} of ${where}`);
}

/** Takes out shapes that need files, and those the specification does not know. Returns how many. */
function checkShapes(link: Element): number {
  let missing = 0;
  const where = `link '${attribute(link, 'name')}'`;
  for (const other of [...childrenOf(link, 'collision'), ...childrenOf(link, 'inertial')]) other.remove();
  for (const visual of childrenOf(link, 'visual')) {
    visual.removeAttribute('name');
    checkOrigin(visual, where);
    const geometry = childrenOf(visual, 'geometry');
    const shape = geometry[0]?.children[0];
    if (geometry.length !== 1 || !shape || !kSolids.has(nameOf(shape))) {
      missing += 1;
      visual.remove();
      continue;
    }
    if (nameOf(shape) === 'box') checkNumbers(attribute(shape, 'size'), 3, `the box of ${where}`);
    else checkNumbers(attribute(shape, 'radius'), 1, `the radius of a ${nameOf(shape)} of ${where}`);
    if (nameOf(shape) === 'cylinder') checkNumbers(attribute(shape, 'length'), 1, `the length of a cylinder of ${where}`);
  }
  return missing;
}

function checkMaterials(robot: Element): void {
  for (const element of [...robot.getElementsByTagName('*')]) {
    if (nameOf(element) === 'texture') element.remove();
    if (nameOf(element) !== 'material') continue;
    const name = attribute(element, 'name');
    if (name in Object.prototype) element.removeAttribute('name');
    for (const colour of childrenOf(element, 'color')) {
      checkNumbers(attribute(colour, 'rgba'), 4, `the colour of material '${name.slice(0, 80)}'`);
      colour.setAttribute('rgba', attribute(colour, 'rgba').trim().replace(/\s+/g, ' '));
    }
  }
}

function jointOf(joint: Element): UrdfJoint {
  const name = attribute(joint, 'name');
  const where = `joint '${name.slice(0, 80)}'`;
  if (!kJointTypes.has(attribute(joint, 'type'))) throw new UrdfError(`The type of ${where} of the URDF is '${attribute(joint, 'type').slice(0, 40)}'; one of ${[...kJointTypes].join(', ')} was needed.`);
  checkOrigin(joint, where);
  for (const end of ['parent', 'child']) if (childrenOf(joint, end).length !== 1) throw new UrdfError(`The ${where} of the URDF has ${childrenOf(joint, end).length} elements '${end}'; one was needed.`);
  const axis = childrenOf(joint, 'axis')[0];
  if (axis) checkNumbers(attribute(axis, 'xyz'), 3, `the axis of ${where}`);
  // Spaces at its ends would be NaN in the loader. Limits are not kept to: what was recorded was so.
  axis?.setAttribute('xyz', attribute(axis, 'xyz').trim());
  for (const limit of childrenOf(joint, 'limit')) limit.remove();
  const mimic = childrenOf(joint, 'mimic')[0];
  for (const one of ['multiplier', 'offset']) if (mimic?.hasAttribute(one)) checkNumbers(attribute(mimic, one), 1, `the ${one} of ${where}`);
  return { name, parent: attribute(childrenOf(joint, 'parent')[0], 'link'), child: attribute(childrenOf(joint, 'child')[0], 'link'), ...(mimic ? { follows: attribute(mimic, 'joint') } : {}) };
}

/** A document that can be loaded without harm; `missing` shapes were taken out. */
function checked(text: string): { document: Document; missing: number; root: string } {
  if (text.length > kMaxUrdfChars) throw new UrdfError(`The URDF has ${text.length} characters; at most ${kMaxUrdfChars} are read.`);
  // Entities can grow without end, and URDF has no use for them.
  if (/<!(DOCTYPE|ENTITY)/i.test(text)) throw new UrdfError('The URDF defines entities of XML (<!DOCTYPE>), which are not read.');
  const document = new DOMParser().parseFromString(text, 'text/xml');
  const fault = document.querySelector('parsererror');
  if (fault) throw new UrdfError(`The URDF is no XML: ${(fault.textContent ?? '').replace(/\s+/g, ' ').slice(0, 160)}`);
  const robot = document.documentElement;
  const elements = robot.getElementsByTagName('*').length;
  if (elements > kMaxUrdfElements) throw new UrdfError(`The URDF has ${elements} elements; at most ${kMaxUrdfElements} are read.`);
  // What is for simulators may use the same names in other ways.
  for (const child of [...robot.children]) if (!['link', 'joint', 'material'].includes(nameOf(child))) child.remove();
  const links = childrenOf(robot, 'link');
  const joints = childrenOf(robot, 'joint');
  const root = checkTree(links.map((link) => attribute(link, 'name')), joints.map(jointOf));
  const missing = links.reduce((sum, link) => sum + checkShapes(link), 0);
  const shapes = links.reduce((sum, link) => sum + childrenOf(link, 'visual').length, 0);
  if (shapes > kMaxShapes) throw new UrdfError(`The URDF has ${shapes} shapes; at most ${kMaxShapes} are drawn.`);
  checkMaterials(robot);
  return { document, missing, root };
}

export interface Robot {
  readonly object: THREE.Object3D;
  readonly root: string;
  readonly joints: ReadonlySet<string>;
  /** Shapes that are not drawn, because they are in files. */
  readonly missing: number;
  /** Puts it where it was, and its joints as they were; joints that nothing tells stay at zero. */
  readonly pose: (base: Placed | undefined, positions: ReadonlyMap<string, number>) => void;
  /** Where its links are, in the frame of the world, in m. */
  readonly links: () => { readonly name: string; readonly position: readonly [number, number, number] }[];
}

/** Reads a URDF; as a ghost it is translucent and of one colour. Throws UrdfError. */
export function createRobot(text: string, ghost?: string): Robot {
  const { document, missing, root } = checked(text);
  const loader = new URDFLoader();
  loader.loadMeshCb = () => {};
  let robot: URDFRobot;
  try {
    robot = loader.parse(document);
  } catch (error) {
    throw new UrdfError(`The URDF cannot be drawn: ${error instanceof Error ? error.message : String(error)}`);
  }
  const material = ghost === undefined ? undefined : new THREE.MeshLambertMaterial({ color: ghost, transparent: true, opacity: 0.32, depthWrite: false });
  if (material) robot.traverse((part) => { if (part instanceof THREE.Mesh) part.material = material; });
  const movable = Object.entries(robot.joints).filter(([, joint]) => ['revolute', 'continuous', 'prismatic'].includes(joint.jointType));
  for (const [, joint] of movable) joint.ignoreLimits = true;
  return {
    object: robot, root, missing, joints: new Set(movable.map(([name]) => name)),
    pose(base, positions) {
      robot.position.set(...(base?.position ?? [0, 0, 0]));
      const [w, x, y, z] = base?.orientation ?? [1, 0, 0, 0];
      robot.quaternion.set(x, y, z, w).normalize();
      for (const [name, joint] of movable) if (!('mimicJoint' in joint)) joint.setJointValue(positions.get(name) ?? 0);
      robot.updateMatrixWorld(true);
    },
    links: () => Object.entries(robot.links).map(([name, link]) => {
      const at = new THREE.Vector3().setFromMatrixPosition(link.matrixWorld);
      return { name, position: [at.x, at.y, at.z] as const };
    }),
  };
}
