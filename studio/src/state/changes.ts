/** Changes: wraps functions so that they run only if a value differs from the last one. */

/** Returns a function that calls `load` if its value is another object than at the last call. */
export function changes<T>(load: (value: T) => void): (value: T) => void {
  let last: T | undefined;
  return (value) => {
    if (value === last) return;
    last = value;
    load(value);
  };
}
