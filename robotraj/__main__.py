"""``python -m robotraj`` is ``robotraj``."""

from robotraj.cli.app import app

app()
