/** The parts of gifenc that the page uses; gifenc brings no types. */
declare module "gifenc/dist/gifenc.esm.js" {
  type Palette = number[][];
  /** A palette of at most this many colours for pixels of four bytes. */
  export function quantize(rgba: Uint8ClampedArray, most: number): Palette;
  /** The colour of each pixel, by number. */
  export function applyPalette(rgba: Uint8ClampedArray, palette: Palette): Uint8Array;
  export function GIFEncoder(): {
    /** A picture; it stays for `delay` ms. */
    writeFrame(pixels: Uint8Array, width: number, height: number, options: { palette: Palette; delay: number }): void;
    finish(): void;
    bytes(): Uint8Array<ArrayBuffer>;
  };
}
