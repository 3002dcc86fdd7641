// SPDX-License-Identifier: Apache-2.0
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

const here = (path: string) => fileURLToPath(new URL(path, import.meta.url));

// The tests of the page lie with all other tests, and their libraries here. The build makes the page
// elsewhere, and says where the tests are.
export default defineConfig({
  resolve: { alias: { 'playwright-core': here('node_modules/playwright-core/index.mjs'), '@mock': here('mock'), '@web': here('.') } },
  server: { fs: { strict: false } },
  test: {
    dir: process.env.PAGE_TESTS ?? here('../../tests/viewer/page'), include: ['**/*.test.ts'], environment: 'node', fileParallelism: false,
    testTimeout: 120_000, hookTimeout: 60_000,
    // Builds may share the machine, and browsers draw in software there.
    expect: { poll: { timeout: 10_000 } },
  },
});
