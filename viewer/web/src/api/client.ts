// SPDX-License-Identifier: Apache-2.0
// The one place that talks to the gateway. It only ever asks the host that served the page.
import { DecodeError, object, string, withDefault, type Decoder } from './decode';

/** Why something could not be shown, in words for a person. */
export class ApiError extends Error {
  constructor(readonly code: string, message: string) {
    super(message);
    this.name = 'ApiError';
  }
}

let memory = 0;
/** Which of the gateway's memories all questions are about; 0: the first one. */
export const askMemory = (number: number): void => { memory = number; };
export const askedMemory = (): number => memory;

export type Params = Record<string, string | number | bigint | undefined | readonly string[]>;

export function urlOf(path: string, params: Params): string {
  const query = new URLSearchParams();
  for (const [key, value] of Object.entries(params)) {
    if (value === undefined) continue;
    for (const one of Array.isArray(value) ? value : [value]) query.append(key, String(one));
  }
  if (memory > 0) query.append('memory', String(memory));
  const text = query.toString();
  return `/api/${path}${text ? `?${text}` : ''}`;
}

const refusal = object({ error: object({ code: withDefault(string, 'unknown'), message: string }) });

async function failure(response: Response): Promise<ApiError> {
  if (response.status === 401 || response.status === 403)
    return new ApiError('permission denied', 'The gateway does not know this browser. Open the address that `engram view` printed, with its token.');
  try {
    const { error } = refusal(await response.json(), '');
    return new ApiError(error.code, error.message);
  } catch {
    return new ApiError('unknown', `The gateway answered ${response.status} ${response.statusText}.`);
  }
}

async function ask(path: string, params: Params, signal?: AbortSignal): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(urlOf(path, params), { credentials: 'same-origin', redirect: 'error', ...(signal ? { signal } : {}) });
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    throw new ApiError('unavailable', 'The gateway does not answer. Is `engram view` still running? Start it again and reload.');
  }
  if (!response.ok) throw await failure(response);
  return response;
}

export async function getJson<T>(path: string, params: Params, decode: Decoder<T>, signal?: AbortSignal): Promise<T> {
  const response = await ask(path, params, signal);
  try {
    return decode(await response.json(), '');
  } catch (error) {
    if (error instanceof DecodeError) throw new ApiError('data loss', `/api/${path}: ${error.message}. Gateway and page may be of different versions.`);
    if (error instanceof SyntaxError) throw new ApiError('data loss', `/api/${path}: the answer is no JSON.`);
    throw error;
  }
}

export interface Binary {
  readonly buffer: ArrayBuffer;
  readonly headers: Headers;
}

export async function getBinary(path: string, params: Params, signal?: AbortSignal): Promise<Binary> {
  const response = await ask(path, params, signal);
  return { buffer: await response.arrayBuffer(), headers: response.headers };
}

export interface Picture {
  readonly bitmap: ImageBitmap;
  readonly source: string;
  readonly model?: string;
  readonly engine?: string;
  readonly psnr?: number;
  readonly bytes?: number;
  readonly gain?: number;
  readonly expectedError?: number;
  readonly bound?: number;
  /** Values of black and white, where they are no colours: depth. */
  readonly range?: readonly [number, number];
}

export async function getImage(params: Params, signal?: AbortSignal): Promise<Picture> {
  const response = await ask('image', params, signal);
  const text = (name: string) => response.headers.get(`X-Engram-${name}`) ?? undefined;
  const value = (name: string) => {
    const found = Number.parseFloat(text(name) ?? '');
    return Number.isFinite(found) ? found : undefined;
  };
  const [low, high] = [value('Min'), value('Max')];
  let bitmap: ImageBitmap;
  try {
    bitmap = await createImageBitmap(await response.blob());
  } catch {
    throw new ApiError('data loss', 'The gateway sent something that is no image.');
  }
  return {
    bitmap, source: text('Source') ?? 'unknown', model: text('Model'), engine: text('Engine'), psnr: value('PSNR'), bytes: value('Bytes'), gain: value('Gain'),
    expectedError: value('Expected-Error'), bound: value('Bound'), ...(low !== undefined && high !== undefined ? { range: [low, high] as const } : {}),
  };
}
