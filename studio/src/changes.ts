/** Changes: functions that run only if a value differs from the one before. */

/** Runs `load` when `value` is another object than at the last call. */
export function changes<T>(load: (value: T) => void): (value: T) => void {
  let last: T | undefined;
  return (value) => {
    if (value === last) return;
    last = value;
    load(value);
  };
}
