// SPDX-License-Identifier: Apache-2.0
/** Where a value comes from, in the colour of its lane; Engram also says `reconstructed` for latents. */
export function SourceTag(props: { source: string }) {
  const colour = () => (props.source === 'reconstructed' ? 'latent' : props.source);
  return <span class={`source ${colour()}`}>{props.source}</span>;
}
