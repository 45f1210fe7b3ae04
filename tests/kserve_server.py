# SPDX-License-Identifier: Apache-2.0
"""Serves an ONNX network with the kserve package and onnxruntime: kserve_server.py MODEL.onnx NAME PORT."""
import sys

import kserve
import onnxruntime

TYPES = {"tensor(float)": "FP32", "tensor(uint8)": "UINT8", "tensor(int64)": "INT64"}


class OnnxModel(kserve.Model):
    def __init__(self, name, path):
        super().__init__(name)
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        self.session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
        self.ready = True

    @staticmethod
    def describe(values):
        return [{"name": value.name, "datatype": TYPES[value.type],
                 "shape": [size if isinstance(size, int) else -1 for size in value.shape]} for value in values]

    async def get_input_types(self):
        return self.describe(self.session.get_inputs())

    async def get_output_types(self):
        return self.describe(self.session.get_outputs())

    def predict(self, payload, headers=None, response_headers=None):
        inputs = {tensor.name: tensor.as_numpy() for tensor in payload.inputs}
        outputs = []
        for value, array in zip(self.session.get_outputs(), self.session.run(None, inputs)):
            output = kserve.InferOutput(value.name, list(array.shape), TYPES[value.type])
            output.set_data_from_numpy(array, binary_data=True)
            outputs.append(output)
        return kserve.InferResponse(payload.id or "", self.name, outputs)


if __name__ == "__main__":
    kserve.ModelServer(http_port=int(sys.argv[3]), enable_grpc=False, workers=1).start([OnnxModel(sys.argv[2], sys.argv[1])])
