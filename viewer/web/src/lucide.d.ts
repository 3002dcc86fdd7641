// SPDX-License-Identifier: Apache-2.0
// Single icons: the package types its index alone, which would name all of them.
declare module 'lucide/dist/esm/icons/*.mjs' {
  const icon: readonly (readonly [string, Record<string, string | number>])[];
  export default icon;
}
