// SPDX-License-Identifier: Apache-2.0
// Stands where urdf-loader wants its loaders of meshes (vite.config.ts): the page asks no other place
// for files, and a memory has no meshes.
const refuse = (): never => { throw new Error('The page loads no meshes.'); };

export class STLLoader {
  readonly load = refuse;
}
export class ColladaLoader {
  readonly load = refuse;
}
