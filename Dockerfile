# The program alone on a small system; runs belong to whoever starts it:
#     docker build -t pbif --build-arg PBIF_COMMIT="$(git rev-parse HEAD)" .
#     docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/work" pbif sweep mine.toml
FROM rust:1-slim-bookworm AS build
WORKDIR /pbif
COPY . .
# The commit for run.json, as there is no .git here.
ARG PBIF_COMMIT
RUN cargo build --release --locked

FROM debian:bookworm-slim
COPY --from=build /pbif/target/release/pbif /usr/local/bin/pbif
COPY sweeps /usr/local/share/pbif/sweeps
COPY LICENSE-APACHE LICENSE-MIT licenses /usr/local/share/pbif/
WORKDIR /work
ENTRYPOINT ["pbif"]
