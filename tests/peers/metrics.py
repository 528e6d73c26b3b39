"""Reads figures as Prometheus does and prints them as one JSON object, with the parser of the package prometheus-client."""

import json
import sys
import urllib.request

from prometheus_client.openmetrics.parser import text_string_to_metric_families

with urllib.request.urlopen(sys.argv[1], timeout=10) as response:
    assert response.headers["Content-Type"].startswith("application/openmetrics-text"), response.headers
    text = response.read().decode()
families = list(text_string_to_metric_families(text))
assert all(family.documentation for family in families), text
print(json.dumps({sample.name: sample.value for family in families for sample in family.samples}))
