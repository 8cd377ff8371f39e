// The connection to the run: what it tells, and the stop button.

const address = new URL(window.location.href);

/** The token of this page: from its address, or as it was typed before. */
function token() {
  return address.searchParams.get("token") ?? sessionStorage.getItem("token");
}

function withToken(path) {
  const known = token();
  return known === null ? path : `${path}?token=${encodeURIComponent(known)}`;
}

/** Keeps a token that was typed. */
export function keepToken(text) {
  address.searchParams.delete("token");
  sessionStorage.setItem("token", text);
}

/** The scene; throws `refused` where the token is missing or wrong. */
export async function scene() {
  const answer = await fetch(withToken("scene.json"));
  if (answer.status === 403) {
    throw new Error("refused");
  }
  if (!answer.ok) {
    throw new Error(`the program answers ${answer.status}`);
  }
  return answer.json();
}

/**
 * Follows the run. `heard` is given each list of [topic, message]; `begun` is called whenever the
 * connection is made, and then the run is told from its beginning; `lost` when it breaks.
 */
export function follow({ begun, heard, lost }) {
  const events = new EventSource(withToken("events"));
  events.onopen = begun;
  events.onmessage = (event) => {
    const messages = JSON.parse(event.data);
    heard(messages);
    if (messages.some(([topic]) => topic === "end")) {
      events.close();
    }
  };
  events.onerror = lost;
}

/** Stops the arm; throws where the program does not confirm it. */
export async function stop() {
  const answer = await fetch(withToken("stop"), { method: "POST" });
  if (!answer.ok) {
    throw new Error(`the program answers ${answer.status}`);
  }
}
