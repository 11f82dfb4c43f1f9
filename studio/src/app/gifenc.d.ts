/** The functions of gifenc that the page uses; gifenc has no types of its own. */
declare module "gifenc/dist/gifenc.esm.js" {
  type Palette = number[][];
  /** Returns a palette of at most this many colours for pixels of four bytes. */
  export function quantize(rgba: Uint8ClampedArray, most: number): Palette;
  /** Returns the index of each pixel's colour in the palette. */
  export function applyPalette(rgba: Uint8ClampedArray, palette: Palette): Uint8Array;
  export function GIFEncoder(): {
    /** Adds a picture that is shown for `delay` ms. */
    writeFrame(pixels: Uint8Array, width: number, height: number, options: { palette: Palette; delay: number }): void;
    finish(): void;
    bytes(): Uint8Array<ArrayBuffer>;
  };
}
