// What the program sends: a head of JSON, then arrays, each of whole words of four bytes.
const ARRAYS = { f32: Float32Array, u32: Uint32Array, i8: Int8Array };

// The head, with its arrays by name, and by name the runs in which they differ from those before; nothing where they are new. New ones are
// views of the buffer; in old ones of the same length what has changed is written.
export function unpack(buffer, before) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let offset = 4 + length;
  const arrays = {}, changes = {};
  for (const { name, kind, words, runs } of head.arrays) {
    const Kind = ARRAYS[kind], width = 4 / Kind.BYTES_PER_ELEMENT;
    if (!runs) {
      arrays[name] = new Kind(buffer, offset, width * words);
      offset += 4 * words;
      continue;
    }
    let array = before.arrays[name];
    if (array.length === width * words) {
      changes[name] = runs.map(([start, count]) => [width * start, width * count]);
    } else {
      array = new Kind(width * words);
      array.set(before.arrays[name].subarray(0, width * words));
    }
    for (const [start, count] of runs) {
      array.set(new Kind(buffer, offset, width * count), width * start);
      offset += 4 * count;
    }
    arrays[name] = array;
  }
  return { head, arrays, changes };
}
