// What the program sends: a head of JSON, then arrays, each from a multiple of four bytes on.
const ARRAYS = { f32: Float32Array, u32: Uint32Array, i8: Int8Array };

// The head, with its arrays by name. They are views of the buffer: nothing is copied.
export function unpack(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let offset = 4 + length;
  const arrays = {};
  for (const { name, kind, count } of head.arrays) {
    arrays[name] = new ARRAYS[kind](buffer, offset, count);
    offset += 4 * Math.ceil(arrays[name].byteLength / 4);
  }
  return { head, arrays };
}
