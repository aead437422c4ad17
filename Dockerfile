# robotraj from its source: docker build -t robotraj . && docker run --rm -v "$PWD:/work" robotraj demo
FROM python:3.12 AS build
COPY . /source
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels /source

FROM python:3.12-slim
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir /wheels/*.whl && rm -r /wheels
WORKDIR /work
ENTRYPOINT ["robotraj"]
CMD ["demo"]
