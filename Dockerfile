# The demo, and ident for logs of one's own (mount them, and give the call: ... ssmr_ident inspect /logs/roll-1.xlsx):
#   docker build -t ssmr_ident . && docker run --rm -v "$PWD/out:/out" ssmr_ident
FROM python:3.12-slim
WORKDIR /source
COPY pyproject.toml README.md LICENSE ./
COPY src src
RUN pip install --no-cache-dir .
ENTRYPOINT ["ident"]
CMD ["demo", "-o", "/out"]
