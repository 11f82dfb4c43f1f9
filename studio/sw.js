// Service worker: stores the site's files at the first visit, and serves them when the network fails.
const NAME = "midair VERSION";
const FILES = [];

self.addEventListener("install", (event) => event.waitUntil(caches.open(NAME).then((kept) => kept.addAll(FILES)).then(() => self.skipWaiting())));

self.addEventListener("activate", (event) => {
  const old = (names) => names.filter((name) => name.startsWith("midair ") && name !== NAME);
  event.waitUntil(caches.keys().then((names) => Promise.all(old(names).map((name) => caches.delete(name)))).then(() => self.clients.claim()));
});

self.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET" || !event.request.url.startsWith(self.location.origin)) return;
  const kept = async (error) => {
    const found = await caches.match(event.request, { ignoreSearch: true });
    if (found) return found;
    throw error;
  };
  event.respondWith(fetch(event.request).catch(kept));
});
