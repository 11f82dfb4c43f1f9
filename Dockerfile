# The README's two commands: docker build --tag midair . runs make demo; docker run --rm midair runs make test.
FROM rust:1.95-bookworm AS tools
RUN apt-get update && apt-get install --yes --no-install-recommends python3-venv && rm -rf /var/lib/apt/lists/*
RUN rustup component add clippy rustfmt

FROM tools
WORKDIR /midair
COPY . .
RUN make demo
CMD ["make", "test"]
