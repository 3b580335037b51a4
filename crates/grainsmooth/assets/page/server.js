// Asks the program that serves this page.
const secret = document.querySelector("meta[name=page-secret]").content;

// What was refused, with the reason that the program gave.
export class Refused extends Error {
  constructor(status, why) {
    super(why);
    this.status = status;
  }
}

async function post(path, words) {
  let response;
  try {
    response = await fetch(path, {
      method: "POST",
      headers: { "content-type": "application/json", "x-page-secret": secret },
      body: JSON.stringify(words ?? null),
    });
  } catch {
    throw new Refused(0, "The program has ended; start it again.");
  }
  if (!response.ok) throw new Refused(response.status, (await response.json()).refused);
  return response;
}

export async function askBytes(path, words) {
  return (await post(path, words)).arrayBuffer();
}

export async function ask(path, words) {
  return (await post(path, words)).json();
}

// Runs `work` for the newest words alone: one at a time, what comes in between is left out.
export function newest(work) {
  let isBusy = false, next = null;
  return async function run(...words) {
    if (isBusy) {
      next = words;
      return;
    }
    isBusy = true;
    try {
      await work(...words);
    } finally {
      isBusy = false;
      if (next) {
        const words = next;
        next = null;
        run(...words);
      }
    }
  };
}
