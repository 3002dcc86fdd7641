// SPDX-License-Identifier: Apache-2.0
// What a text must be to be drawn as a robot. A URDF comes from a memory, so it may say anything:
// what would hang the page, or ask for a file, is found here, before a loader reads it.

/** Real robots with hands have some hundred kB. */
export const kMaxUrdfChars = 4_000_000;
/** The loader looks through all elements once for each link. */
export const kMaxUrdfElements = 20_000;
export const kMaxLinks = 1_000;
export const kMaxShapes = 2_000;
/** Links behind each other; drawing goes down the tree by recursion. */
export const kMaxLinksInRow = 400;

/** Why a URDF is not drawn, in words for a person. */
export class UrdfError extends Error {}

/** True if the root element of a text is `robot`, behind a declaration and comments. */
export function isUrdf(text: string): boolean {
  let at = 0;
  const skipTo = (end: string): boolean => {
    const found = text.indexOf(end, at);
    if (found < 0) return false;
    at = found + end.length;
    return true;
  };
  // Each turn passes something, so that a long text of spaces and comments takes no longer.
  for (;;) {
    while (at < text.length && /[\s\uFEFF]/.test(text[at]!)) ++at;
    if (text.startsWith('<?', at)) { if (!skipTo('?>')) return false; }
    else if (text.startsWith('<!--', at)) { if (!skipTo('-->')) return false; }
    // Whatever a document type defines is refused later, with a word on it.
    else if (text.startsWith('<!', at)) return /<robot[\s>/]/.test(text);
    else return /^<robot[\s>/]/.test(text.slice(at, at + 8));
  }
}

/** The first text in a value that is a URDF. */
export function urdfIn(value: unknown, depth = 0): string | undefined {
  if (typeof value === 'string') return isUrdf(value) ? value : undefined;
  if (typeof value !== 'object' || value === null || depth > 6) return undefined;
  for (const part of Object.values(value)) {
    const found = urdfIn(part, depth + 1);
    if (found !== undefined) return found;
  }
  return undefined;
}

export interface UrdfJoint {
  readonly name: string;
  readonly parent: string;
  readonly child: string;
  /** The joint that this one follows. */
  readonly follows?: string;
}

/** Names are keys of plain objects and parts of selectors in the loader. */
function checkNames(what: string, names: readonly string[]): Set<string> {
  const seen = new Set<string>();
  for (const name of names) {
    const shown = name.slice(0, 80);
    if (name === '') throw new UrdfError(`A ${what} of the URDF has no name.`);
    if (name.length > 200 || /["'\\\]\0-\x1f]/.test(name) || name in Object.prototype) throw new UrdfError(`The URDF has a ${what} named '${shown}', which is no name.`);
    if (seen.has(name)) throw new UrdfError(`The URDF has two ${what}s named '${shown}'.`);
    seen.add(name);
  }
  return seen;
}

/** Throws unless links and joints are one tree. Returns the name of its root. */
export function checkTree(links: readonly string[], joints: readonly UrdfJoint[]): string {
  if (links.length === 0) throw new UrdfError('The URDF has no links.');
  if (links.length > kMaxLinks || joints.length > kMaxLinks) throw new UrdfError(`The URDF has ${Math.max(links.length, joints.length)} links or joints; at most ${kMaxLinks} are drawn.`);
  const known = checkNames('link', links);
  const byName = new Map(joints.map((joint) => [joint.name, joint]));
  checkNames('joint', joints.map((joint) => joint.name));
  const children = new Map<string, string[]>();
  const parentOf = new Map<string, string>();
  for (const { name, parent, child } of joints) {
    for (const link of [parent, child]) if (!known.has(link)) throw new UrdfError(`Joint '${name}' of the URDF names a link '${link.slice(0, 80)}' that is not there.`);
    if (parentOf.has(child)) throw new UrdfError(`Link '${child}' of the URDF hangs on two joints.`);
    parentOf.set(child, parent);
    children.set(parent, [...(children.get(parent) ?? []), child]);
  }
  const roots = links.filter((link) => !parentOf.has(link));
  if (roots.length === 0) throw new UrdfError('The links of the URDF hang on each other in a circle.');
  if (roots.length > 1) throw new UrdfError(`The URDF is in ${roots.length} pieces: '${roots[0]}' and '${roots[1]}' both hang on nothing.`);
  let reached = 0;
  let level = roots;
  for (let depth = 0; level.length > 0; ++depth) {
    if (depth >= kMaxLinksInRow) throw new UrdfError(`More than ${kMaxLinksInRow} links of the URDF hang on each other in a row.`);
    reached += level.length;
    level = level.flatMap((link) => children.get(link) ?? []);
  }
  if (reached < links.length) throw new UrdfError('Some links of the URDF hang on each other in a circle.');
  for (const joint of joints) {
    if (joint.follows === undefined) continue;
    const leader = byName.get(joint.follows);
    if (!leader) throw new UrdfError(`Joint '${joint.name}' of the URDF follows a joint '${joint.follows.slice(0, 80)}' that is not there.`);
    // The loader would follow such a chain by recursion; robots have no chains of them.
    if (leader.follows !== undefined) throw new UrdfError(`Joint '${joint.name}' of the URDF follows '${leader.name}', which follows another one.`);
  }
  return roots[0]!;
}

/** Throws unless a text is as many finite numbers as are needed, none beyond a kilometre. */
export function checkNumbers(text: string, count: number, where: string): void {
  const parts = text.trim().split(/\s+/);
  if (parts.length !== count || !parts.every((part) => part !== '' && Math.abs(Number(part)) <= 1e3))
    throw new UrdfError(`The URDF says '${text.slice(0, 60)}' for ${where}; ${count === 1 ? 'a number' : `${count} numbers`} up to 1000 ${count === 1 ? 'was' : 'were'} needed.`);
}
