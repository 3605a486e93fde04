# The program alone on a small system: docker build -t pbif . && docker run --rm -v "$PWD:/work" pbif sweep mine.toml
FROM rust:1-slim-bookworm AS build
WORKDIR /pbif
COPY . .
RUN cargo build --release --locked

FROM debian:bookworm-slim
COPY --from=build /pbif/target/release/pbif /usr/local/bin/pbif
COPY sweeps /usr/local/share/pbif/sweeps
COPY LICENSE-APACHE LICENSE-MIT licenses /usr/local/share/pbif/
WORKDIR /work
ENTRYPOINT ["pbif"]
