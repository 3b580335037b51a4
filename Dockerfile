# grainsmooth without Rust on the machine:
#
#     docker build --tag grainsmooth .
#     docker run --rm --user "$(id -u)" --volume "$PWD:/work" grainsmooth --seeds 200 -n 3
FROM rust:1.90-slim AS build
WORKDIR /source
COPY . .
RUN cargo install --locked --path . --root /installed

FROM debian:stable-slim
COPY --from=build /installed/bin/grainsmooth /usr/local/bin/
WORKDIR /work
ENTRYPOINT ["grainsmooth"]
