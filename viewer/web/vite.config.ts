// SPDX-License-Identifier: Apache-2.0
import { fileURLToPath } from 'node:url';
import type { IncomingMessage, ServerResponse } from 'node:http';
import { defineConfig, type Plugin } from 'vite';
import solid from 'vite-plugin-solid';

/** Answers /api/ of `npm run dev` from the imagined memory, so that no gateway is needed. */
function mockGateway(): Plugin {
  return {
    name: 'mock-gateway',
    apply: 'serve',
    async configureServer(server) {
      // A name that the compiler cannot follow: the mock is plain JavaScript without types.
      const path = new URL('./mock/handler.mjs', import.meta.url).href;
      const { answer } = (await import(path)) as { answer: (url: URL) => { status: number; type: string; headers: Record<string, string>; body: string } };
      server.middlewares.use((request: IncomingMessage, response: ServerResponse, next: () => void) => {
        const url = new URL(request.url ?? '/', 'http://127.0.0.1');
        if (!url.pathname.startsWith('/api/')) return next();
        const { status, type, headers, body } = answer(url);
        response.writeHead(status, { 'Content-Type': type, ...headers }).end(body);
      });
    },
  };
}

// urdf-loader can load meshes from anywhere. The page shall not, and is smaller without.
const noMeshes = fileURLToPath(new URL('src/panels/scene/noMeshes.ts', import.meta.url));

export default defineConfig({
  resolve: { alias: { 'three/examples/jsm/loaders/STLLoader.js': noMeshes, 'three/examples/jsm/loaders/ColladaLoader.js': noMeshes } },
  plugins: [solid(), mockGateway()],
  build: {
    target: 'es2022',
    // Files and never data: or inline code, because the policy of the page allows neither.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
    // three.js is that large, and loaded when it is needed; tools/sizes.mjs has the bars.
    chunkSizeWarningLimit: 600,
  },
  test: { include: ['src/**/*.test.ts'], environment: 'node' },
} as Parameters<typeof defineConfig>[0]);
